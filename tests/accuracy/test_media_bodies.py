"""Bodies of media in even light, attenuation, and a lamp in fog.

Truths: closed forms, and what the tests name. False alarms: 0.01 for each test. A long file, as each closed
form stands next to its scene.
"""

from math import exp, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import (
    BLACK,
    EDGE,
    along,
    film,
    from_above,
    lit_slab,
    measured_scene,
    medium,
    quad,
    sphere,
    surface,
)
from scipy.integrate import quad as integral

from tests.accuracy.agreement import ROUNDING, Values
from tests.accuracy.media import read
from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_SAMPLES = 32

_KERNEL_ONLY: Document = {"estimator": "mixture", "mixture": {"kernel": 1.0, "environment": 0.0}, "h": 1e6}
"""No photon is aimed or dies: where nothing is absorbed, each carries 1 to the end."""

_GAP = 1e-4
"""Between a film and a body of size 1. Past the body goes a part of 2 x gap of the light."""


def _body(shape: Document, fog: Document, sensor: Document, **more: Any) -> Document:
    """A body of a medium in even light of radiance 1."""
    body = {"shape": shape, "interior": {"media": ["fog"]}, **more}
    document = measured_scene(sensor, [body], **_KERNEL_ONLY)
    return document | {"media": {"fog": fog}, "environment": {"radiance": 1.0}}


@pytest.mark.parametrize("depth", [0.1, 1.0, 2.0, 5.0])
def test_absorption(depth: float, tmp_path: Path) -> None:
    """Sphere of absorption x radius = depth and slab of optical thickness depth, under Lambertian light.

    (1 - (1 + 2 d) exp(-2 d)) / (2 d^2), and 2 E3(d); along the normal exp(-d).
    """
    slab_truth = {0.1: 0.83258292, 1.0: 0.21938393, 2.0: 0.06026676, 5.0: 0.0017556018}[depth]
    ball_truth = (1.0 - (1.0 + 2.0 * depth) * exp(-2.0 * depth)) / (2.0 * depth * depth)
    fog = {"absorption": depth}
    ball = _body(sphere([0, 0, 0], 1.0), fog, film([0, 0, 1.0 + _GAP], [0, 0, -1], 1e-4))
    (read(ball, tmp_path / "ball", _SAMPLES) * (1.0 / pi)).check(
        (1.0 - 2.0 * _GAP) * ball_truth + 2.0 * _GAP, 1e-4, values=3
    )
    for key, sensor, truth in (
        ("diffuse", from_above(1e-4), slab_truth * pi),
        ("normal", along(0.0, 2.0), exp(-depth)),
    ):
        document = lit_slab(fog, 1.0, sensor, below=True)
        read(document, tmp_path / key, _SAMPLES).check(truth, EDGE, values=3)


def test_absorption_that_grows_with_depth(tmp_path: Path) -> None:
    """0.6 z per metre over 3 m: exp(-2.7)."""
    density = {"layers": [[-3.0, 0.0], [0.0, 3.0]], "above": {"point": [0, 0, 0], "up": [0, 0, 1]}}
    document = lit_slab({"absorption": 0.6, "density": density}, 3.0, along(0.0, 2.0), below=True)
    read(document, tmp_path, 16 * _SAMPLES).check(exp(-2.7), ROUNDING)


@pytest.mark.parametrize(
    ("shape", "index", "length"),
    [("sphere", 1.0, 4.0 / 3.0), ("sphere", 1.5, 3.0), ("cube", 1.0, 2.0 / 3.0)],
)
@pytest.mark.parametrize(("scattering", "g"), [(1.0, -0.5), (10.0, 0.0), (10.0, 0.9)])
def test_mean_path_length(
    shape: str, index: float, length: float, scattering: float, g: float, tmp_path: Path
) -> None:
    """4 V / S, times n^2, however the medium scatters (Blanco and Fournier, Europhysics Letters 61, 2003).

    From the light that a trace of absorption takes: absorption x mean length, less half of the square's mean,
    at most a part of absorption x (1 + 1.8^2) x length / 2.
    """
    absorption = 1e-3
    fog: Document = {"scattering": scattering, "absorption": absorption}
    fog["phase"] = {"type": "henyey_greenstein", "g": g}
    kernel = {} if index == 1.0 else {"kernel": {"type": "dielectric", "index": index}}
    if shape == "sphere":
        document = _body(sphere([0, 0, 0], 1.0), fog, film([0, 0, 1.0 + _GAP], [0, 0, -1], 1e-3), **kernel)
    else:
        # A whole face; pixels differ a little, which adds to the standard error only.
        box = {"type": "box", "minimum": [-0.5, -0.5, -1.0], "maximum": [0.5, 0.5, 0.0]}
        document = _body(box, fog, film([0, 0, _GAP], [0, 0, -1], 1.0))
    lost = (read(document, tmp_path, 4 * _SAMPLES) * (1.0 / pi) - 1.0) * (-1.0 / absorption)
    # Rounding of a number near 1, of which a thousandth counts; and light that passes the body.
    lost.check(length, absorption * 4.3 * length / 2.0 + 1e-3 + 4.0 * _GAP)


@pytest.mark.parametrize(("scattering", "g"), [(1.0, -0.5), (10.0, 0.0), (10.0, 0.9)])
def test_mean_path_length_in_a_cylinder(scattering: float, g: float, tmp_path: Path) -> None:
    """The same for a closed cylinder of radius 0.5 and height 2: 0.8, by light from everywhere.

    An intensity meter sends parallel beams through it from all directions: its loss, in the mean over
    directions, is absorption x volume. Columns of pixels are independent. Standard error: 1 %.
    """
    absorption, around = 1e-3, 1.2
    fog: Document = {"scattering": scattering, "absorption": absorption}
    fog["phase"] = {"type": "henyey_greenstein", "g": g}
    meter = {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": around}
    document = _body(_cylinder(0.5, 2.0), fog, meter)
    size = 16
    lost = pi * around**2 - _grey(Measurement(document, tmp_path, size, size), 1024)
    edges = np.cos(np.linspace(0.0, pi, size + 1))
    mean = (lost * (0.5 * (edges[:-1] - edges[1:]))[:, None]).sum(axis=0)
    # The mean chord is 4 V / S, and the mean projected area S / 4.
    surface_area = 2.0 * pi * 0.5 * (0.5 + 2.0)
    length = Reading.of(mean) * (4.0 / (absorption * surface_area))
    length.check(0.8, absorption * 4.3 * 0.8 / 2.0 + 2e-3)


def _cylinder(radius: float, height: float) -> Document:
    """Around the z axis. A prism around the circle: the same 4 V / S, and S larger by a part of 2e-4."""
    corners = 128
    angles = 2.0 * pi / corners * np.arange(corners)
    circle = radius / np.cos(pi / corners) * np.column_stack([np.cos(angles), np.sin(angles)])
    rings = [np.column_stack([circle, np.full(corners, z)]) for z in (-0.5 * height, 0.5 * height)]
    vertices = np.concatenate([*rings, [[0.0, 0.0, -0.5 * height], [0.0, 0.0, 0.5 * height]]])
    here = np.arange(corners)
    after = (here + 1) % corners
    low, high = np.full(corners, 2 * corners), np.full(corners, 2 * corners + 1)
    sides = [(here, after, after + corners), (here, after + corners, here + corners)]
    triangles = [*sides, (low, after, here), (high, here + corners, after + corners)]
    indices = np.concatenate([np.column_stack(triangle) for triangle in triangles])
    return {"type": "mesh", "vertices": vertices.tolist(), "triangles": indices.tolist()}


@pytest.mark.parametrize("g", [-0.5, 0.0, 0.9])
@pytest.mark.parametrize("scattering", [1.0, 100.0])
def test_white_furnace(g: float, scattering: float, tmp_path: Path) -> None:
    """A medium that absorbs nothing is invisible in even light: every photon brings back 1, to rounding."""
    fog = medium(1.0, g, scattering)
    camera = {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": 25,
    }
    document = _body(sphere([0, 0, 0], 1.0), fog, camera)
    grey = _grey(Measurement(document, tmp_path, 16, 16), 16)
    assert grey == pytest.approx(np.ones((16, 16)), rel=ROUNDING)


def test_white_furnace_of_optical_thickness_10000(tmp_path: Path) -> None:
    """4 V / S x 5000 collisions on average; what the limit of a million ends is missing, and told."""
    sensor = film([0, 0, 1.0 + _GAP], [0, 0, -1], 1e-3)
    document = _body(sphere([0, 0, 0], 1.0), medium(1.0, 0.0, 5000.0), sensor)
    measurement = Measurement(document, tmp_path, 4, 4)
    grey = _grey(measurement, 16) / pi
    photons = measurement.statistics["photons"] / grey.size
    lost = np.round((1.0 - grey) * photons)
    assert grey + lost / photons == pytest.approx(np.ones((4, 4)), rel=ROUNDING)
    assert lost.sum() == measurement.statistics["truncated_paths"] <= 0.01 * photons * grey.size


def _grey(measurement: Measurement, samples: int, seed: int = 0) -> Values:
    image = measurement.image(samples, seed)
    return image.further["grey"].astype(np.float64) / (830.0 - 360.0)


@pytest.mark.parametrize(
    ("thickness", "truth", "samples"),
    [
        pytest.param(50.0, 0.025929798, 64, id="50"),
        # Eleven photons of 8192 are transmitted: a third of the precision of 50, in ten times its time.
        pytest.param(1000.0, 0.0013314415, 16, id="1000", marks=pytest.mark.soak),
        # Photons that pass 10,000 collide some 1e8 times: beyond the bound of a photon, 2^20.
    ],
)
def test_a_very_thick_slab(thickness: float, truth: float, samples: int, tmp_path: Path) -> None:
    """Asymptotic theory, isotropic, albedo 1: diffuse light that comes through, and collisions of a photon.

    They are 2 x thickness on average (4 V / S). Photons are followed one by one, and none ends early: what
    comes through is a count, with the bounds of the binomial distribution.
    """
    document = lit_slab(medium(1.0), thickness, from_above(1e-3), below=True)
    document["tracing"] = {**_KERNEL_ONLY, "photons_together": 1, "sequence": "independent"}
    measurement = Measurement(document, tmp_path, 8, 8)
    through, collisions = [], []
    for seed in range(8):
        through.append(_grey(measurement, samples, seed).mean() / pi)
        # Three rays end elsewhere: on the slab's faces, before and after, and beyond.
        collisions.append(measurement.statistics["rays"] / measurement.statistics["photons"] - 3.0)
    _check_count(float(np.mean(through)), truth, 8 * 64 * samples, values=2)
    Reading.of(np.array(collisions)).check(2.0 * thickness, EDGE, values=2)


@pytest.mark.parametrize(
    ("thickness", "truth", "samples"),
    [
        pytest.param(50.0, 0.032648698, 256, id="50"),
        pytest.param(1000.0, 0.0016764431, 64, id="1000", marks=pytest.mark.soak),
    ],
)
def test_a_beam_through_a_thick_slab(thickness: float, truth: float, samples: int, tmp_path: Path) -> None:
    """The same along the normal, by the count of photons that come through."""
    document = lit_slab(medium(1.0), thickness, along(0.0, 2.0), below=True)
    document["tracing"] = {**_KERNEL_ONLY, "photons_together": 1, "sequence": "independent"}
    through = _grey(Measurement(document, tmp_path, 8, 8), samples).mean()
    _check_count(float(through), truth, 64 * samples)


def _check_count(part: float, truth: float, photons: int, values: int = 1) -> None:
    """Of photons that come through or not, as many as the binomial distribution has it; false alarms: 0.01
    for all `values` that a test looks at."""
    # Late: it takes two seconds, in each process that only collects this file.
    from scipy import stats

    low, high = stats.binom.interval(1.0 - 0.01 / values, photons, truth * (1.0 - EDGE))
    assert low <= round(part * photons) <= high


def test_the_law_of_darkening(tmp_path: Path) -> None:
    """Milne's problem: radiance of a thick slab lit from behind, over that of a Lambertian surface that gives
    as much light: sqrt(3) / 4 x pi x H(mu) / pi (Chandrasekhar, Radiative Transfer, ch. III and V).

    At an optical thickness of 12 it is that of a half space to 1e-5. Along the face H is 1. Transmission
    follows from Hopf's constant q, 0.71044609: 4 / 3 / (thickness + 2 q).
    """
    flux = read(
        lit_slab(medium(1.0), 12.0, from_above(1e-3), below=True),
        tmp_path / "flux",
        8 * _SAMPLES,
    )
    (flux * (1.0 / pi)).check(4.0 / 3.0 / (12.0 + 2.0 * 0.71044609), EDGE, values=5)
    assert _h_of_white(1.0) == pytest.approx(2.9078105, rel=1e-7)
    at_face = 0.4330127 * _h_of_white(1e-3)
    for mu, truth in ((1.0, 1.2591189), (0.5, 0.87155877), (0.2, 0.62802058), (1e-3, at_face)):
        sensor = along(float(np.degrees(np.arccos(mu))), 2.0)
        document = lit_slab(medium(1.0), 12.0, sensor, below=True)
        radiance = read(document, tmp_path / str(mu), 8 * _SAMPLES)
        # The error of a quotient, by the larger of the two.
        part = float(np.hypot(radiance.error / radiance.mean, flux.error / flux.mean))
        ratio = type(flux)(radiance.mean * pi / flux.mean, part * radiance.mean * pi / flux.mean, flux.count)
        ratio.check(truth, EDGE, values=5)


def _h_of_white(mu: float) -> float:
    """Chandrasekhar's H function for isotropic scattering without absorption (ch. V, eq. 40)."""
    logarithm = integral(
        lambda x: np.log1p(-x / np.tan(x)) / (np.cos(x) ** 2 + (mu * np.sin(x)) ** 2), 0.0, pi / 2
    )[0]
    return exp(-mu / pi * logarithm)


def test_fog_without_end(tmp_path: Path) -> None:
    """A shining black ball of 20 free paths in fog that fills space and absorbs nothing, seen from 30.

    Radiance is a / (1 + l / a) / r across the direction to the ball, as diffusion has it beyond the ball's
    skin, with Milne's extrapolation length l of 0.71 for a plane, 0.75 at most for such a ball (Davison,
    Neutron Transport Theory, 1957, ch. IV): 0.6435, known to 3e-3 with what diffusion leaves out.
    """
    ball = {"shape": sphere([0, 0, 0], 20.0), "kernel": BLACK, "luminaire": {"radiance": 1.0}}
    sensor = along(0.0, 2.0) | {"position": [30.0, 0.0, 0.0], "look_at": [30.0, 1.0, 0.0], "up": [0, 0, 1]}
    document = measured_scene(sensor, [ball])
    document |= {"media": {"fog": medium(1.0)}, "unbounded_media": ["fog"]}
    read(document, tmp_path, _SAMPLES).check(0.6435, 3e-3)


# Extinction, scattering, g, distance of the lamp from the ray, where the ray starts and ends; 0 is the
# point of the ray nearest to the lamp.
_AIRLIGHTS = {
    (0.0, 0.01, 0.0, 1.0, -10.0, 10.0): 0.0023413724,
    (0.1, 0.1, 0.0, 1.0, -10.0, 30.0): 0.0072677269,
    (0.1, 0.1, 0.7, 2.0, -10.0, 30.0): 0.0049883781,
    (1.0, 1.0, 0.0, 0.1, -2.0, 4.0): 0.2726994,
    (0.1, 0.1, -0.3, 2.0, -10.0, 30.0): 0.0027345704,
}


@pytest.mark.parametrize("case", _AIRLIGHTS, ids=str)
def test_airlight(case: tuple[float, float, float, float, float, float], tmp_path: Path) -> None:
    """Light of a lamp of 1 W/sr that fog scatters once into a ray (quadrature).

    The scene has 1e-4 of the scattering and 1e4 times the light, so light that is scattered twice is less
    than a part of 3e-4. So is the loss by scattering alone in cases without extinction.
    """
    extinction, scattering, g, beside, start, end = case
    part, radius = 1e-4, beside / 1000.0
    lamp = surface(sphere([0, beside, 0], radius), BLACK, 1.0 / (part * pi * radius**2))
    wall = surface(quad([end, -9e3, -9e3], [0, 18e3, 0], [0, 0, 18e3]))
    sensor = {
        "type": "radiance_meter",
        "position": [start, 0, 0],
        "look_at": [end, 0, 0],
        "diameter": 1e-6,
        "cone_degrees": 1e-4,
    }
    document = measured_scene(sensor, [lamp, wall])
    fog: Document = {"scattering": part * scattering, "absorption": max(extinction - part * scattering, 0.0)}
    fog |= {"phase": {"type": "henyey_greenstein", "g": g}} if g else {}
    document |= {"media": {"fog": fog}, "unbounded_media": ["fog"]}
    # Few photons meet the lamp: with fewer than these their mean is not normal.
    read(document, tmp_path, 64 * _SAMPLES).check(_AIRLIGHTS[case], 4e-4)


def test_attenuation_through_air_around_a_planet(tmp_path: Path) -> None:
    """Optical depths along rays from the ground of a planet of 6371 km, air of scale height 8 km.

    1 straight up, 1.992577 at 60 degrees, 5.55052 at 80 and 35.38532 at the horizon (quadrature). The last
    two with a fifth and a tenth of the air. The sensor stands 1 mm above the ground.
    """
    for degrees, depth, part in ((0, 1.0, 1.0), (60, 1.992577, 1.0), (80, 5.55052, 0.2), (90, 35.38532, 0.1)):
        angle = np.radians(degrees)
        sensor = along(0.0, 2.0)
        sensor |= {"position": [0, 0.001, 0], "diameter": 1e-4, "cone_degrees": 1e-4}
        sensor["look_at"] = [float(np.sin(angle)), 0.001 + float(np.cos(angle)), 0.0]
        sensor["up"] = [0, 0, 1]
        document = _planet({"absorption": part / 8000.0}, sensor)
        read(document, tmp_path / str(degrees), _SAMPLES).check(exp(-part * depth), 1e-4, values=4)


def _planet(air: Document, sensor: Document) -> Document:
    """As `$.atmosphere` makes it, with a gas that only absorbs; 400 km hold all but exp(-50) of it."""
    centre, radius = [0.0, -6_371_000.0, 0.0], 6_371_000.0
    density = {"scale_height": 8000.0, "above": {"centre": centre, "radius": radius}}
    shell = {"shape": sphere(centre, radius + 400_000.0), "interior": {"media": ["air"]}}
    ground = surface(sphere(centre, radius))
    document = measured_scene(sensor, [shell, ground])
    return document | {"media": {"air": {**air, "density": density}}, "environment": {"radiance": 1.0}}


def test_a_planet_and_a_scene_in_millimetres(tmp_path: Path) -> None:
    """Under 100 km of air, below a black ball of 1 mm whose centre is 2 mm above the ground of 6371 km.

    In even light, air that only scatters and white ground have radiance 1, but for what the ball hides
    from the ground below it, (1 / 2)^2. Were the ground 0.1 mm too high, it would hide 0.277.
    """
    ball = surface(sphere([0, 0.002, 0], 0.001))
    sensor = {
        "type": "radiance_meter",
        "position": [0.01, 0.0005, 0],
        "look_at": [0, 0, 0],
        "up": [0, 0, 1],
        "diameter": 1e-6,
        "cone_degrees": 1e-4,
    }
    document = measured_scene(sensor, [ball])
    document |= {"environment": {"radiance": 1.0}, "atmosphere": {"ground_reflectance": 1.0}}
    # Seen at a slant the disc is 20 micrometres long: 1e-4 of the hidden part.
    read(document, tmp_path, 8 * _SAMPLES).check(0.75, 1e-4)
