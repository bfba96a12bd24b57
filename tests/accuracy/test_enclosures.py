"""Enclosures with many diffuse reflections, whose irradiance or radiosity is known exactly.

On the inside of a sphere every part lights every other evenly, so diffusely reflected light is the same
everywhere; a port, cut off by a flat black disc, takes the share of the sphere's area behind it.
"""

from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.validation.cie171 import CUBE_CAMERA, cube_walls
from nocturne_scene.validation.documents import (
    BLACK,
    GREY,
    diffuse,
    disc,
    film,
    furnace,
    measured_scene,
    sphere,
    surface,
)
from nocturne_scene.validation.enclosures import INSIDE, integrating_sphere, lamp_of, on_wall, port
from nocturne_scene.validation.truths import truths

from tests.accuracy.meters import Measurement, check_equal
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

CIE_171: dict[str, Any] = truths("cie171")

_SPHERES = [
    # Radius, reflectance, fraction of ports, M = rho / (1 - rho (1 - f)), photons that travel together.
    pytest.param(1.0, 0.5, 0.0, 1.0, 4, id="0.5 closed"),
    pytest.param(1.0, 0.95, 0.05, 9.7435897, 1, id="0.95 port 0.05"),
    pytest.param(1e4, 0.95, 0.05, 9.7435897, 4, id="0.95 port 0.05, 10 km"),
    pytest.param(1.0, 0.98, 0.01, 32.885906, 4, id="0.98 port 0.01"),
    pytest.param(1.0, 0.9, 0.02, 7.6271186, 4, id="0.9 port 0.02"),
]


@pytest.mark.parametrize(("radius", "reflectance", "fraction", "multiplier", "together"), _SPHERES)
def test_integrating_sphere(
    radius: float, reflectance: float, fraction: float, multiplier: float, together: int, tmp_path: Path
) -> None:
    """Indirect irradiance is M times the flux on the wall over the sphere's area, opposite to the port and
    next to it (Labsphere, Integrating Sphere Theory and Applications). False alarms: 0.01."""
    height, edge = port(1.0, min(1.01 * fraction, 1.0)) if fraction else (0.0, 1.0)
    surfaces = integrating_sphere(radius, reflectance, fraction)
    for i, place in enumerate(([0.0, 0.0, -1.0], [edge, 0.0, height])):
        folder = tmp_path / str(i)
        folder.mkdir()
        scene = measured_scene(on_wall(radius, place), surfaces, photons_together=together)
        total = Measurement(scene, folder, 8, 8).by_pixels(128)
        # Direct light from the middle, at the film; the wall gets 4 pi (1 - f), its area is 4 pi r^2.
        direct = 1.0 / ((1.0 - INSIDE) * radius) ** 2
        indirect = multiplier * (1.0 - fraction) / radius**2
        total.check(direct + indirect, 3e-5, values=2)


@pytest.mark.parametrize(
    ("reflectance", "fraction", "multiplier"),
    [(0.95, 0.05, 9.7435897), (0.98, 0.01, 32.885906), (0.9, 0.02, 7.6271186)],
)
def test_both_directions_read_the_port(
    reflectance: float, fraction: float, multiplier: float, tmp_path: Path
) -> None:
    """The port's flux is f M of what lands on the wall, and f of the lamp's. False alarms: 0.01.

    The film is 1e-4 in front of the port and reaches beyond the sphere, where it is dark; between film and
    port is a rim of wall, less than 1e-3 of the port's area.
    """
    height, edge = port(1.0, fraction)
    gap = 1e-4 * edge
    sensor = film([0, 0, height - gap], [0, 0, -1], 2.1 * edge)
    surfaces = integrating_sphere(1.0, reflectance, fraction)
    truth = 4.0 * pi * fraction * (1.0 + multiplier * (1.0 - fraction)) / (2.1 * edge) ** 2
    readings = []
    for direction, samples in (("adjoint", 512), ("forward", 2048)):
        folder = tmp_path / direction
        folder.mkdir()
        scene = measured_scene(sensor, surfaces, direction=direction)
        readings.append(Measurement(scene, folder).by_seeds(samples))
    for reading in readings:
        reading.check(truth, 1e-3, values=3)
    check_equal(readings[0], readings[1], values=3)


@pytest.mark.parametrize(
    ("reflectance", "fraction", "hits"),
    [(0.5, 0.0, 2.0), (0.95, 0.05, 10.25641), (0.98, 0.01, 33.557047), (0.9, 0.02, 8.4745763)],
)
def test_wall_hits(reflectance: float, fraction: float, hits: float, tmp_path: Path) -> None:
    """Forward photons that survive by albedo: rays per photon are 1 and, after each hit that is survived, 1.

    Of the photons 1 - f land on the wall first, `hits` is the mean number of theirs. 0.01 false alarms; one
    photon's hits have a standard deviation below `hits` + 1. Crossing the lamp again costs a ray: 1e-6.
    """
    scene = measured_scene(
        film([0, 0, -0.5], [0, 0, 1], 0.1),
        integrating_sphere(1.0, reflectance, fraction, 0.001),
        direction="forward",
        roulette="albedo",
        roulette_after=0,
        h=1.0,
        sequence="independent",
        photons_together=1,
    )
    measurement = Measurement(scene, tmp_path, 1, 1)
    measurement.image(2**16)
    statistics = measurement.statistics
    assert statistics["photons"] == 2**16
    # The lamp's own surface is crossed by no photon that leaves it.
    rays = statistics["rays"] / statistics["photons"]
    truth = 1.0 + (1.0 - fraction) * reflectance * hits
    assert abs(rays - truth) < 2.6 * (hits + 1.0) / sqrt(2**16) + 1e-5 * truth


@pytest.mark.parametrize(
    ("inner", "outer", "rho_inner", "rho_outer", "b_inner", "b_outer"),
    [
        (1.0, 2.0, 0.5, 0.5, 1.1111111, 0.22222222),
        (1.0, 1.05, 0.9, 0.9, 5.0449438, 4.494382),
        (0.5, 1.0, 0.3, 0.95, 1.3294798, 1.0982659),
    ],
)
def test_concentric_spheres(
    inner: float,
    outer: float,
    rho_inner: float,
    rho_outer: float,
    b_inner: float,
    b_outer: float,
    tmp_path: Path,
) -> None:
    """Radiosities by F12 = 1, F21 = (r1 / r2)^2, F22 = 1 - F21; exitance 1 of the inner sphere (Modest,
    Radiative Heat Transfer). False alarms: 0.01."""
    surfaces = [
        surface(sphere([0, 0, 0], inner), diffuse(rho_inner), 1.0 / pi),
        surface(sphere([0, 0, 0], outer), diffuse(rho_outer)),
    ]
    between = [0.0, 0.0, (inner + outer) / 2]
    for name, towards, truth in (("in", [0.02, 0.01, 0.0], b_inner), ("out", [0.02, 0.01, 5.0], b_outer)):
        folder = tmp_path / name
        folder.mkdir()
        sensor = _radiance_meter(between, towards)
        reading = Measurement(measured_scene(sensor, surfaces), folder, 8, 8).by_pixels(128) * pi
        reading.check(truth, values=2)


def _radiance_meter(position: list[float], look_at: list[float]) -> Document:
    return {
        "type": "radiance_meter",
        "position": position,
        "look_at": look_at,
        "diameter": 1e-4,
        "cone_degrees": 0.1,
    }


@pytest.mark.parametrize(
    ("distance", "reflectance", "exitances", "centres", "means"),
    [
        (1.0, 0.8, (1, 1), (1.5909796, 1.5909796), (1.4459616, 1.4459616)),
        (0.2, 0.95, (1, 1), (7.5045801, 7.5045801), (5.3145032, 5.3145032)),
        (0.5, 0.8, (1, 0), (1.5047392, 0.90853206), (1.3380961, 0.66195974)),
    ],
)
def test_coaxial_discs(
    distance: float,
    reflectance: float,
    exitances: tuple[float, float],
    centres: tuple[float, float],
    means: tuple[float, float],
    tmp_path: Path,
) -> None:
    """Radiosities of two unit discs that face each other (Sparrow and Cess, Radiation Heat Transfer: Fredholm
    equation with the ring-to-ring kernel, solved by Nystrom's method). False alarms: 0.01.

    Uncertainty: the discs' rims are polygons, which takes 1e-4 of what the film sees, and 5e-5 of the light
    exchanged.
    """
    kernel = {"type": "two_sided", "front": diffuse(reflectance), "back": BLACK}
    surfaces = [
        surface(disc([0, 0, 0], [0, 0, 1], 1.0, 256), kernel, exitances[0] / pi),
        surface(disc([0, 0, distance], [0, 0, -1], 1.0, 256), kernel, exitances[1] / pi),
    ]
    middle = [0.0, 0.0, distance / 2]
    for disc_index in (0, 1):
        # Off the centre, where all triangles meet; radiosity there is less by about 1e-5.
        aim = [1e-3, 5e-4, disc_index * distance]
        cameras = {
            "centre": _radiance_meter(middle, aim),
            "mean": {"type": "orthographic", "position": middle, "look_at": [0, 0, aim[2]], "height": 2.0},
        }
        for name, camera in cameras.items():
            folder = tmp_path / f"{name}{disc_index}"
            folder.mkdir()
            document = measured_scene(camera, surfaces)
            if name == "centre":
                reading = Measurement(document, folder, 8, 8).by_pixels(64) * pi
                reading.check(centres[disc_index], 1e-4, values=4)
            else:
                # The film of 2 x 2 sees a disc of area pi and nothing else.
                reading = Measurement(document, folder).by_seeds(256) * 4.0
                reading.check(means[disc_index], 2e-4, values=4)


@pytest.mark.parametrize(
    ("emissivity", "fraction", "effective"), [(0.5, 0.1, 0.90909091), (0.9, 0.02, 0.99778271)]
)
def test_spherical_cavity(emissivity: float, fraction: float, effective: float, tmp_path: Path) -> None:
    """Radiance of the aperture of a cavity at one temperature, over that of a black body (Gouffe 1945; DeWitt
    and Nutter, Theory and Practice of Radiation Thermometry). The same from all directions and places, so any
    film in the aperture reads pi times it. False alarms: 0.01."""
    height, edge = port(1.0, fraction)
    surfaces = [
        surface(sphere([0, 0, 0], 1.0), diffuse(1.0 - emissivity), emissivity, two_sided=True),
        surface(disc([0, 0, height], [0, 0, -1], edge)),
    ]
    readings = []
    for direction, samples in (("adjoint", 512), ("forward", 2048)):
        folder = tmp_path / direction
        folder.mkdir()
        # The film's corners are well inside the aperture's rim.
        scene = measured_scene(film([0, 0, height], [0, 0, -1], edge), surfaces, direction=direction)
        readings.append(Measurement(scene, folder).by_seeds(samples) * (1.0 / pi))
    for reading in readings:
        reading.check(effective, 2e-5, values=3)
    check_equal(readings[0], readings[1], uncertainty=2e-5, values=3)


@pytest.mark.parametrize("reflectance", list(CIE_171["5.8"]["lx"]))
def test_cie_171_5_8_cube(reflectance: str, tmp_path: Path) -> None:
    """Mean illuminance of a wall; all six have the same. A published validation of another renderer was 32 %
    too low at 0.95, by a limit on reflections. False alarms: 0.01.

    A camera sees one whole wall, whose radiosity is the reflectance times the illuminance. The lamp is a
    sphere of 1 cm that light passes through: the mean depends on its flux alone. Uncertainty: rounding
    of the direct light, which is taken off.
    """
    lamp = lamp_of([2, 2, 2], 1.0, 10_000.0)
    walls = cube_walls(float(reflectance))
    seen = Measurement(measured_scene(CUBE_CAMERA, [*walls, lamp]), tmp_path).by_seeds(512)
    indirect = seen * (pi / float(reflectance)) - 10_000.0 / 96.0
    indirect.check(CIE_171["5.8"]["lx"][reflectance], 2e-5 / float(reflectance))


# Albedo, edge of the film in pixels, samples. What takes minutes is for `make soak`. 0.999 with few samples
# still has an error of 2 %, where a limit on interactions once took 37 %.
_ALBEDOS = [
    pytest.param(0.9, 8, 16, id="0.9"),
    pytest.param(0.99, 8, 16, id="0.99"),
    pytest.param(0.995, 8, 16, id="0.995"),
    pytest.param(0.999, 8, 4, id="0.999"),
    pytest.param(0.999, 16, 16, id="0.999 again", marks=pytest.mark.soak),
    pytest.param(0.9995, 16, 16, id="0.9995", marks=pytest.mark.soak),
    pytest.param(0.9999, 16, 16, id="0.9999", marks=pytest.mark.soak),
]


_CLOSED = [("sphere", "adjoint"), ("sphere", "both"), ("box", "adjoint"), ("box", "both"), ("box", "forward")]


@pytest.mark.parametrize(("albedo", "edge", "samples"), _ALBEDOS)
@pytest.mark.parametrize(("shape", "direction"), _CLOSED)
def test_closed_ones_that_absorb_little(
    shape: str, direction: str, albedo: float, edge: int, samples: int, tmp_path: Path
) -> None:
    """As by default: light is reflected 1 / (1 - albedo) times on average, and many times that counts, too.

    z by the scatter of pixels, or of images of other seeds where one forward photon meets many pixels; within
    the bound for all of this test's, false alarms: 0.01.
    """
    if shape == "box":
        document = furnace(albedo, 1.0) | {"tracing": {"direction": direction}}
        document["sensor"] |= GREY
        truth = 1.0 / (1.0 - albedo)
        if direction == "forward":
            document["sensor"] = {**GREY, **film([0.5, 0.5, 0.5], [0, 0, 1], 0.5)}
            truth *= pi
    else:
        # Past the lamp in the middle.
        place: Document = {"position": [0.5, 0, 0], "look_at": [0.9, 0.1, 0.3]}
        camera = {"type": "pinhole", "vertical_field_of_view_degrees": 30.0, **place}
        document = measured_scene(camera, integrating_sphere(1.0, albedo, 0.0), direction=direction)
        truth = albedo / (1.0 - albedo) / pi
    measurement = Measurement(document, tmp_path, edge, edge)
    reading = measurement.by_seeds(2) if direction == "forward" else measurement.by_pixels(samples)
    reading.check(truth, values=len(_CLOSED) * len(_ALBEDOS))
    # One sample is off by a few times the truth, whatever the albedo.
    assert reading.error < 0.2 * truth
