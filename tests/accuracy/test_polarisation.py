"""Polarised light against formulas and published tables.

S1 is positive where the field is along the sensor's right (horizontal), S2 where it is along the middle
between right and up, S3 where it turns clockwise as the sensor sees it. Long: one file has all that a sensor,
a lamp and something between them show.
"""

import cmath
from math import cos, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client import contract
from nocturne_client.local.measuring import measure_file
from nocturne_scene.validation.documents import BLACK, GREY, along, box, quad, slab, sun, surface

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

_UP = [0, 0, 1]


def _meter(position: list[float], look_at: list[float], up: list[float] | None = None) -> Document:
    return {
        "type": "radiance_meter",
        "position": position,
        "look_at": look_at,
        "up": up or _UP,
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
        "stokes": True,
        **GREY,
    }


def _scene(sensor: Document, surfaces: list[Document], **more: Any) -> Document:
    return {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, **more}


def _across(y: float, kernel: Any, half: float = 1.0) -> Document:
    """A square across the y axis."""
    return {"shape": quad([-half, y, -half], [0, 0, 2 * half], [2 * half, 0, 0]), "kernel": kernel}


_LAMP = _across(3.0, BLACK) | {"luminaire": {"radiance": 1.0, "two_sided": True}}


def _check(
    document: Document, folder: Path, stokes: tuple[float, ...], samples: int = 64, **allowed: Any
) -> None:
    measurement = Measurement(document, folder, 8, 8)
    for name, truth in zip(("grey", "S1.grey", "S2.grey", "S3.grey"), stokes, strict=True):
        reading = measurement.by_pixels(samples, name)
        bound = (
            reading.bound(allowed.get("values", 4)) * reading.error
            + allowed.get("uncertainty", 2e-6) * stokes[0]
        )
        assert abs(reading.mean - truth) <= bound, (name, reading, truth)


def _axis(degrees: float) -> list[float]:
    """Of a filter across the y axis, from right towards up, for a sensor that looks along y."""
    return [cos(radians(degrees)), 0.0, sin(radians(degrees))]


def _through(*filters: Document) -> Document:
    """From the sensor to the lamp."""
    sensor = _meter([0, 0, 0], [0, 1, 0])
    placed = [_across(0.5 + 0.25 * number, kernel) for number, kernel in enumerate(filters)]
    return _scene(sensor, [*placed, _LAMP])


def _polariser(degrees: float, **more: Any) -> Document:
    return {"type": "polariser", "axis": _axis(degrees), **more}


@pytest.mark.parametrize("degrees", [0, 30, 45, 90, 135])
def test_a_polariser(degrees: float, tmp_path: Path) -> None:
    twice = radians(2 * degrees)
    _check(_through(_polariser(degrees)), tmp_path, (0.5, 0.5 * cos(twice), 0.5 * sin(twice), 0.0))


def test_malus(tmp_path: Path) -> None:
    """Behind a leaky polariser at 20 degrees one at 65 degrees lets through what is along it."""
    leaky = _polariser(20, transmittance=0.8, leakage=0.2)
    through = 0.5 * (0.8 * cos(radians(45)) ** 2 + 0.2 * sin(radians(45)) ** 2)
    expected = (through, through * cos(radians(130)), through * sin(radians(130)), 0.0)
    _check(_through(_polariser(65), leaky), tmp_path, expected)


def test_a_quarter_wave_makes_circular_light(tmp_path: Path) -> None:
    """Light along the middle between right and up: behind a quarter-wave plate whose fast axis is to the
    right, the upward part is a quarter behind, so that the field turns counterclockwise as seen from where it
    goes: the textbooks' left-handed light, S3 < 0."""
    plate = {"type": "retarder", "axis": _axis(0), "retardance_degrees": 90}
    _check(_through(plate, _polariser(45)), tmp_path, (0.5, 0.0, 0.0, -0.5))


def test_a_retarder_between_crossed_polarisers(tmp_path: Path) -> None:
    """sin^2 of half the retardance, by wavelength: integrated over the meter's range."""
    plate = {"type": "retarder", "axis": _axis(45), "retardance_nm": 300}
    nm = np.linspace(360, 830, 4701)
    mean = 0.5 * float(np.trapezoid(np.sin(pi * 300 / nm) ** 2, nm)) / (830 - 360)
    document = _through(_polariser(90), plate, _polariser(0))
    _check(document, tmp_path, (mean, -mean, 0.0, 0.0), 1024, uncertainty=2e-5)


def _fresnel(cosine: float, index: complex) -> tuple[complex, complex]:
    """Of the field across and in the plane of incidence, the latter to the right of the ray where the former
    is up; waves as e^(i k z)."""
    root = cmath.sqrt(index * index - (1 - cosine * cosine))
    across = (cosine - root) / (cosine + root)
    within = (index * index * cosine - root) / (index * index * cosine + root)
    return across, within


def _reflected(stokes: tuple[float, ...], across: complex, within: complex) -> tuple[float, ...]:
    """By the Jones vector of each part."""
    s0, s1, s2, s3 = stokes
    product = across * within.conjugate()
    mean, half = (abs(across) ** 2 + abs(within) ** 2) / 2, (abs(across) ** 2 - abs(within) ** 2) / 2
    turned = product * complex(s2, s3)
    return mean * s0 + half * s1, half * s0 + mean * s1, turned.real, turned.imag


def _on_floor(degrees: float, kernel: Any, filters: Document | None = None, below: Any = ()) -> Document:
    """A sensor that looks down at a floor along y, and a lamp where it mirrors; a filter before the lamp."""
    angle = radians(degrees)
    sensor = _meter([0, -sin(angle), cos(angle)], [0, 0, 0])
    way = np.array([0, sin(angle), cos(angle)])
    up = np.array([0, -cos(angle), sin(angle)])
    right = np.array([1.0, 0, 0])

    def facing(distance: float, kernel: Any, **more: Any) -> Document:
        corner = distance * way - 0.05 * (right + up)
        return {
            "shape": quad(corner.tolist(), (0.1 * up).tolist(), (0.1 * right).tolist()),
            "kernel": kernel,
            **more,
        }

    lamp = facing(2.0, BLACK, luminaire={"radiance": 1.0, "two_sided": True})
    # As the light comes: to the right of who looks from the floor at the lamp is -x; up is the same.
    filtered = [facing(1.0, filters)] if filters else []
    return _scene(sensor, [kernel, *below, lamp, *filtered])


_METAL = {
    "shape": quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]),
    "kernel": {"type": "conductor", "index": {"n": 0.9, "k": 3.2}},
}
_GLASS = {"shape": box([-1, -1, -1], [1, 1, 0]), "kernel": {"type": "dielectric", "index": 1.5}}
_PIT = [surface(quad([-1, -1, -0.5], [2, 0, 0], [0, 2, 0]))]


@pytest.mark.parametrize("degrees", [20, 56.3099, 75])
def test_glass_mirrors(degrees: float, tmp_path: Path) -> None:
    """At Brewster's angle all that is mirrored is polarised across the plane of incidence: horizontally."""
    expected = _reflected((1, 0, 0, 0), *_fresnel(cos(radians(degrees)), 1.5))
    _check(_on_floor(degrees, _GLASS, below=_PIT), tmp_path, expected, 4096)
    if degrees == 56.3099:
        assert expected[1] == pytest.approx(expected[0], rel=1e-9)
        assert expected[0] == pytest.approx(0.147929 / 2, abs=1e-6)


@pytest.mark.parametrize("degrees", [30, 70])
def test_metal_turns_the_phase(degrees: float, tmp_path: Path) -> None:
    """Light at 45 degrees leaves a metal elliptic, by its complex index."""
    angle = radians(degrees)
    # The middle between the direction across the plane of incidence, x, and what follows it
    # counterclockwise for who looks at the lamp from the floor: k cross x with k towards the floor.
    towards = np.array([0, -sin(angle), -cos(angle)])
    axis = np.array([1.0, 0, 0]) + np.cross(towards, [1.0, 0, 0])
    polariser = {"type": "polariser", "axis": axis.tolist()}
    expected = _reflected((0.5, 0, 0.5, 0), *_fresnel(cos(angle), complex(0.9, 3.2)))
    _check(_on_floor(degrees, _METAL, polariser), tmp_path, expected)


def test_total_reflection_in_a_rhomb(tmp_path: Path) -> None:
    """Each of a Fresnel rhomb's reflections, index 1.51 at 50.229 degrees, puts the parts apart by 45.80
    degrees (Born and Wolf, section 1.5.4). Sensor, filter and lamp are inside of the glass."""
    angle = radians(50.229)
    across, within = _fresnel(cos(angle), 1 / 1.51)
    assert abs(np.degrees(cmath.phase(across / within))) == pytest.approx(45.80, abs=0.01)
    towards = np.array([0, -sin(angle), cos(angle)])
    axis = np.array([1.0, 0, 0]) + np.cross(towards, [1.0, 0, 0])
    document = _on_floor(50.229, _METAL, {"type": "polariser", "axis": axis.tolist()})
    flipped = []
    for each in document["surfaces"][1:]:
        shape = each["shape"]
        for name in ("corner", "edge_u", "edge_v"):
            shape[name] = [shape[name][0], shape[name][1], -shape[name][2]]
        flipped.append(each)
    glass = {"shape": box([-5, -5, -5], [5, 5, 0]), "kernel": {"type": "dielectric", "index": 1.51}}
    document["sensor"]["position"][2] *= -1
    document["surfaces"] = [glass, *flipped]
    expected = _reflected((0.5, 0, 0.5, 0), across, within)
    _check(document, tmp_path, expected, 256)


@pytest.mark.parametrize("plates", [1, 10])
def test_a_pile_of_plates(plates: int, tmp_path: Path) -> None:
    """Of N plates at Brewster's angle (1 - R) / (1 + (2 N - 1) R) goes through, in each polarisation."""
    angle = radians(56.3099)
    normal, across = np.array([0, cos(angle), sin(angle)]), np.array([0, -sin(angle), cos(angle)])
    surfaces = []
    for number in range(plates):
        corners = [
            (0.5 + 0.02 * number + 0.01 * back) * normal
            + sideways * 40 * np.array([1.0, 0, 0])
            + along_it * 40 * across
            for back in (0, 1)
            for sideways, along_it in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        faces = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
        faces += [[a, a + 4, b + 4] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
        faces += [[a, b + 4, b] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
        mesh = {"type": "mesh", "vertices": [each.tolist() for each in corners], "triangles": faces}
        surfaces.append({"shape": mesh, "kernel": {"type": "dielectric", "index": 1.5}})
    document = _scene(_meter([0, 0, 0], [0, 1, 0]), [*surfaces, _across(30.0, BLACK, 15.0)])
    document["surfaces"][-1]["luminaire"] = {"radiance": 1.0, "two_sided": True}
    reflected = [abs(each) ** 2 for each in _fresnel(cos(angle), 1.5)]
    through = [(1 - each) / (1 + (2 * plates - 1) * each) for each in reflected]
    s, p = through
    if plates == 10:
        assert (p - s) / (p + s) == pytest.approx(0.635, abs=1e-3)
    # Plates lean towards the light: the plane of incidence holds up, so s is horizontal.
    _check(document, tmp_path, ((s + p) / 2, (s - p) / 2, 0.0, 0.0), 512, uncertainty=1e-5)


@pytest.mark.parametrize("depolarisation", [0.0, 0.0279, 0.1])
def test_molecules_across(depolarisation: float, tmp_path: Path) -> None:
    """Light that is scattered once by 90 degrees is polarised across the plane by (1 - d) / (1 + d)."""
    phase = {"type": "rayleigh", "depolarisation": depolarisation}
    air = {"scattering": 1e-3, "absorption": 0.0, "phase": phase}
    ball = {"shape": {"type": "sphere", "centre": [0, 2, 0], "radius": 1.0}, "interior": {"media": ["air"]}}
    document = _scene(_meter([0, 0, 0], [0, 2, 0]), [ball], media={"air": air})
    document["distant"] = [sun(0)]
    document["tracing"] = {"maximum_depth": 1}
    measurement = Measurement(document, tmp_path, 8, 8)
    light, polarised = (measurement.by_pixels(256, name) for name in ("grey", "S1.grey"))
    expected = (1 - depolarisation) / (1 + depolarisation)
    assert polarised.mean / light.mean == pytest.approx(expected, rel=1e-4)


_COULSON = [
    # Cosine of the zenith angle of the view, azimuth from where light goes, I, Q, U.
    (0.92, 60, 0.05643322, -0.01979730, 0.03822653),
    (0.32, 120, 0.16097330, -0.08476326, 0.00775068),
    (0.64, 0, 0.10231626, 0.02701775, 0.0),
    (0.10, 90, 0.21348201, -0.16821107, 0.06357361),
    (0.64, 150, 0.11652976, -0.01412655, -0.02057393),
]


@pytest.mark.parametrize(("mu", "azimuth", "i", "q", "u"), _COULSON)
def test_the_atmosphere_of_molecules(
    mu: float, azimuth: float, i: float, q: float, u: float, tmp_path: Path
) -> None:
    """Light that leaves a Rayleigh layer of optical depth 0.5 upwards above a black ground, the Sun at a
    cosine of 0.2 with an irradiance of pi: V. Natraj, K.-F. Li and Y. L. Yung, "Rayleigh scattering in
    planetary atmospheres: corrected tables through accurate computation of X and Y functions", Astrophysical
    Journal 691, 2009. Their Q is positive across the meridian plane as ours is; the sign of U is that of the
    side on which the Sun is."""
    across, angle = sqrt(1 - mu * mu), radians(azimuth)
    # Light goes towards -x.
    leaves = np.array([-across * cos(angle), across * sin(angle), mu])
    sensor = _meter((3 * leaves).tolist(), [0, 0, 0])
    air = {"scattering": 1.0, "absorption": 0.0, "phase": {"type": "rayleigh"}}
    document = _scene(sensor, [slab(0.5, 100.0, "air")], media={"air": air})
    document["distant"] = [sun(float(np.degrees(np.arccos(0.2))), irradiance=pi)]
    _check(document, tmp_path, (i, q, u, 0.0), 1024, uncertainty=1e-5, values=20)


def test_diffuse_walls_depolarise(tmp_path: Path) -> None:
    """And nothing else changes: S0 of a room is the same without asking."""
    wall = {"type": "lambertian", "reflectance": 0.5}
    floor = {"shape": quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), "kernel": wall}
    document = _scene(along(30, 2.0) | GREY | {"stokes": True}, [floor], environment={"radiance": 1.0})
    _check(document, tmp_path, (0.5, 0.0, 0.0, 0.0), 256)


def test_a_part_of_an_image_tells_degree_and_angle(tmp_path: Path) -> None:
    """A lamp via glass, as the command line reads it from the file."""
    across, within = (abs(each) ** 2 for each in _fresnel(cos(radians(40)), 1.5))
    expected = (across - within) / (across + within)
    Measurement(_on_floor(40, _GLASS, below=_PIT), tmp_path, 8, 8).image(64)
    whole = contract.Outline(name="", kind="rectangle", points=[[0.0, 0.0], [8.0, 8.0]])
    (measured,) = measure_file(tmp_path / "image.exr", [whole], "grey", 0).measurements
    found = measured.linear_polarisation
    assert found is not None
    low, high = found.degree_interval
    assert low <= expected <= high
    assert high - low < 0.05
    assert found.angle_degrees == pytest.approx(0.0, abs=1e-4) or found.angle_degrees == pytest.approx(180.0)


_SHEET = {"index": 1.52, "transmittance": 0.9}


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    "pane",
    [{"type": "thin_pane", "index": 1.52, "transmittance": 0.9}, {"type": "glazing", "panes": [_SHEET]}],
    ids=["thin pane", "glazing"],
)
def test_a_pane(pane: Document, mirrored: bool, tmp_path: Path) -> None:
    """At 60 degrees R + T² R t² / (1 - R² t²) of each polarisation is mirrored, T² t / (1 - R² t²) passes."""
    angle, index, transmittance = radians(60), 1.52, 0.9
    refracted = cos(np.arcsin(sin(angle) / index))
    left = transmittance ** (1 / refracted)
    shares = []
    for each in _fresnel(cos(angle), index):
        r = abs(each) ** 2
        through = (1 - r) ** 2 * left / (1 - r * r * left * left)
        shares.append(r * (1 + through * left) if mirrored else through)
    s, p = shares
    if mirrored:
        document = _on_floor(60, _METAL | {"kernel": pane})
    else:
        # It leans as a roof does.
        lean = quad(
            [-5, 1 + 5 * sin(angle), -5 * cos(angle)], [0, -10 * sin(angle), 10 * cos(angle)], [10, 0, 0]
        )
        lamp = _across(20.0, BLACK, 5.0) | {"luminaire": {"radiance": 1.0, "two_sided": True}}
        document = _scene(_meter([0, 0, 0], [0, 1, 0]), [{"shape": lean, "kernel": pane}, lamp])
    _check(document, tmp_path, ((s + p) / 2, (s - p) / 2, 0.0, 0.0), 4096, uncertainty=1e-5)


def _from_45_degrees(degrees: float) -> Document:
    """A polariser before the lamp over a floor: S2 is all of the light that falls on the floor."""
    angle = radians(degrees)
    towards = np.array([0, -sin(angle), -cos(angle)])
    return {"type": "polariser", "axis": (np.array([1.0, 0, 0]) + np.cross(towards, [1.0, 0, 0])).tolist()}


def _film(cosine: float, index: float, phase: complex) -> tuple[complex, complex]:
    """Airy's sum of a film in air, across and in the plane of incidence; `phase`: e^(2 i d) of a crossing."""
    across, within = (r * (1 - phase) / (1 - r * r * phase) for r in _fresnel(cosine, index))
    return across, within


def test_a_film_of_soap(tmp_path: Path) -> None:
    """It interferes with itself: the light at 45 degrees that it mirrors, phases included, integrated over
    the meter's wavelengths."""
    degrees, index, thickness = 50.0, 1.4, 300.0
    cosine = cos(radians(degrees))
    refracted = sqrt(1 - (1 - cosine**2) / index**2)
    nm = np.linspace(360, 830, 4701)
    stokes = []
    for each in nm:
        phase = cmath.exp(4j * pi * index * refracted * thickness / each)
        stokes.append(_reflected((0.5, 0, 0.5, 0), *_film(cosine, index, phase)))
    expected = tuple(np.trapezoid(np.array(stokes), nm, axis=0) / (830 - 360))
    film = {"film": [{"index": index, "thickness_nm": thickness}]}
    floor = _METAL | {"kernel": {"type": "glazing", "panes": [film]}}
    document = _on_floor(degrees, floor, _from_45_degrees(degrees))
    _check(document, tmp_path, expected, 8192, uncertainty=3e-5)


_COATED = {"type": "coated_diffuse", "index": 1.5, "reflectance": 0.0}
_PLASTIC = {"type": "principled", "base": 0.0, "index": 1.5, "roughness": 0.0}


@pytest.mark.parametrize("kernel", [_COATED, _PLASTIC], ids=["coated diffuse", "principled"])
def test_a_coat_mirrors_by_amplitudes(kernel: Document, tmp_path: Path) -> None:
    """Over a black base, as glass does; what a base would add is not mirrored."""
    expected = _reflected((0.5, 0, 0.5, 0), *_fresnel(cos(radians(65)), 1.5))
    document = _on_floor(65, _METAL | {"kernel": kernel}, _from_45_degrees(65))
    document["tracing"] = {"sequence": "independent"}
    _check(document, tmp_path, expected, 1024, uncertainty=1e-5)


@pytest.mark.parametrize("base", [0.0, 0.6])
@pytest.mark.parametrize(
    "kernel",
    [_COATED | {"roughness": 0.3}, _PLASTIC | {"roughness": 0.5}],
    ids=["coated diffuse", "principled"],
)
def test_a_rough_coat_over_a_base(kernel: Document, base: float, tmp_path: Path) -> None:
    """Of a facet between both directions, here 55 degrees from each, S1 / S0 is Fresnel's; a base adds light
    that is unpolarised, so that S1 stays the same."""
    kernel = kernel | {"base" if kernel["type"] == "principled" else "reflectance": base}
    floor = {"shape": quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), "kernel": kernel}
    document = _scene(_meter([0, -sin(radians(65)), cos(radians(65))], [0, 0, 0]), [floor])
    # Light comes from 45 degrees beyond the floor, and leaves at 65 degrees: 110 degrees between both.
    document["distant"] = [sun(45, 90)]
    found = Measurement(document, tmp_path, 8, 8)
    light, polarised = (found.by_pixels(256, name).mean for name in ("grey", "S1.grey"))
    across, within = (abs(each) ** 2 for each in _fresnel(cos(radians(55)), 1.5))
    black = document | {"surfaces": [floor | {"kernel": kernel | _without_base(kernel)}]}
    (tmp_path / "black").mkdir()
    mirrored = Measurement(black, tmp_path / "black", 8, 8).by_pixels(256, "grey").mean
    assert polarised / mirrored == pytest.approx((across - within) / (across + within), rel=1e-4)
    assert (light > 1.2 * mirrored) == (base > 0.0)


def _without_base(kernel: Document) -> Document:
    return {"base" if kernel["type"] == "principled" else "reflectance": 0.0}


def test_a_hole_leaves_light_as_it_is(tmp_path: Path) -> None:
    """A mask that lets six tenths through, before light that a polariser at 30 degrees lets through."""
    black = {"type": "lambertian", "reflectance": 0.0}
    mask = {"type": "mask", "kernel": black, "opacity": 0.4}
    twice = radians(60)
    expected = (0.3, 0.3 * cos(twice), 0.3 * sin(twice), 0.0)
    _check(_through(mask, _polariser(30)), tmp_path, expected, 4096, uncertainty=1e-5)


def test_a_blend_mirrors_as_its_parts(tmp_path: Path) -> None:
    """A quarter of glass and three quarters of metal."""
    glass = {"type": "thin_pane", "index": 1.5}
    metal = {"type": "conductor", "index": {"n": 0.9, "k": 3.2}}
    blend = {"type": "blend", "first": glass, "second": metal, "weight": 0.75}
    cosine = cos(radians(60))
    shares = []
    for each in _fresnel(cosine, 1.5):
        r = abs(each) ** 2
        shares.append(2 * r / (1 + r))
    part = _reflected((1, 0, 0, 0), *_fresnel(cosine, complex(0.9, 3.2)))
    s, p = shares
    expected = tuple(
        0.25 * pane + 0.75 * mirror
        for pane, mirror in zip(((s + p) / 2, (s - p) / 2, 0.0, 0.0), part, strict=True)
    )
    _check(_on_floor(60, _METAL | {"kernel": blend}), tmp_path, expected, 4096, uncertainty=1e-5)
