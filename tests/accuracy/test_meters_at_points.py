"""Meters at points and on faces: planes, cylinders, half cylinders, domes, spheres and fluence, against
closed forms.

Readings are of several seeds, by Student's t with their scatter.
"""

from math import atan2, cos, hypot, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.spectra import published
from nocturne_scene.validation.documents import BLACK, quad, sphere, surface

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document, run_seeds

pytestmark = pytest.mark.system

BODIES = ("plane", "cylindrical", "semicylindrical", "hemispherical", "spherical", "fluence")
ELEVATION, AZIMUTH = radians(25.0), radians(40.0)
"""Of the lamp; azimuth from x, which half cylinders face."""
DISTANCE, LUMENS = 2.0, 1000.0


def _meters(*instruments: Document) -> Document:
    return {"type": "meters", "instruments": [*instruments]}


def _all_bodies(place: list[float]) -> Document:
    """z is up."""
    made = []
    for body in BODIES:
        facing = {"facing": [1, 0, 0]} if body == "semicylindrical" else {}
        made.append({"name": body, "points": [place], "normal": [0, 0, 1], "measures": body, **facing})
    return _meters(*made)


def _read(document: Document, folder: Path, samples: int, seeds: int = 8) -> list[Reading]:
    """Of each pixel."""
    sensor = document["sensor"]
    count = sum(len(each.get("points", [0])) for each in sensor["instruments"])
    measured = Measurement({"nocturne": 1, **document}, folder, count, 1)
    images = [image.y for image, _ in run_seeds(measured._planned(samples, 0), folder, seeds)]
    return [Reading.of(values) for values in np.array(images).reshape(seeds, -1).T]


def test_a_small_lamp(tmp_path: Path) -> None:
    """E across the light is I / d^2; a body gets its projected part over its area (EN 12665)."""
    towards = [cos(ELEVATION) * cos(AZIMUTH), cos(ELEVATION) * sin(AZIMUTH), sin(ELEVATION)]
    lamp = {
        "shape": sphere([DISTANCE * each for each in towards], 0.001),
        "kernel": BLACK,
        "luminaire": {"radiance": {"illuminant": "D65"}, "lumens": LUMENS},
    }
    found = _read({"sensor": _all_bodies([0, 0, 0]), "surfaces": [lamp]}, tmp_path, 2048)
    across = LUMENS / (4.0 * pi * DISTANCE**2)
    known = {
        "plane": sin(ELEVATION),
        "cylindrical": cos(ELEVATION) / pi,
        "semicylindrical": cos(ELEVATION) * (1.0 + cos(AZIMUTH)) / pi,
        "hemispherical": (1.0 + sin(ELEVATION)) / 4.0,
        "spherical": 0.25,
        "fluence": 1.0,
    }
    for body, reading in zip(BODIES, found, strict=True):
        reading.check(across * known[body], 1e-4, len(BODIES))
        assert reading.error < 0.01 * across


def test_photons_of_a_known_lamp(tmp_path: Path) -> None:
    """PPFD of a white LED of known spectrum, 1000 lm, straight above: E over what its lumens are in umol/s,
    sum(S l) / (h c N_A) from 400 to 700 nm over 683 sum(S V)."""
    nm = published.visible_wavelengths()
    power = np.interp(nm, *published.illuminant("LED-B3"))
    luminous = 683.0 * float(power @ published.observer("CIE 1931 2 degree")[:, 1])
    # Half of the end points' nanometre is inside.
    inside = np.where((nm > 400) & (nm < 700), 1.0, np.where((nm == 400) | (nm == 700), 0.5, 0.0))
    mole = 6.62607015e-34 * 299792458.0 * 6.02214076e23
    of_a_lumen = float((power * nm * 1e-9) @ inside) / mole * 1e6 / luminous
    lamp = {
        "shape": sphere([0, 0, DISTANCE], 0.001),
        "kernel": BLACK,
        "luminaire": {"radiance": {"illuminant": "LED-B3"}, "lumens": LUMENS},
    }
    sensor = _meters({"name": "leaf", "points": [[0, 0, 0]], "normal": [0, 0, 1]}) | {"measures": "PAR"}
    (found,) = _read({"sensor": sensor, "surfaces": [lamp]}, tmp_path, 4096)
    found.check(LUMENS / (4.0 * pi * DISTANCE**2) * of_a_lumen, 1e-3)
    # Of white LEDs 12 to 16 umol for a thousand lumens and second.
    assert 0.012 < of_a_lumen < 0.018
    assert found.error < 0.01 * found.mean


def test_an_even_light(tmp_path: Path) -> None:
    """pi L for all bodies, and the fluence rate is 4 pi L."""
    far = surface(sphere([0, 0, 1000.0], 0.001), BLACK)
    found = _read(
        {
            "sensor": _all_bodies([0, 0, 0]),
            "surfaces": [far],
            "environment": {"radiance": {"illuminant": "D65", "luminance": 100.0}},
        },
        tmp_path,
        256,
    )
    for body, reading in zip(BODIES, found, strict=True):
        reading.check((400.0 if body == "fluence" else 100.0) * pi, 1e-4, len(BODIES))


def _wall(luminance: float) -> Document:
    return {"radiance": {"constant": 1.0, "luminance": luminance}}


def _solid_angle(x: float, y: float, distance: float) -> float:
    """Of a rectangle from above a corner of it."""
    return atan2(x * y, distance * hypot(x, y, distance))


def test_fluence_before_a_wall_and_the_mean_chord(tmp_path: Path) -> None:
    """In a black cube of edge 1 one wall shines evenly. At a point the fluence rate is L times the wall's
    solid angle. Over the volume its mean is flux times mean chord over volume, and by symmetry the mean chord
    of what one wall sends is that of all six, 4 V / S = 2/3: pi L times 2/3."""
    luminance = 1000.0
    nodes, weights = np.polynomial.legendre.leggauss(5)
    at, weight = 0.5 * (nodes + 1.0), 0.5 * weights
    points = [[float(x), float(y), float(z)] for x in at for y in at for z in at]
    shares = np.array([a * b * c for a in weight for b in weight for c in weight])
    shining = surface(quad([0, 0, 0], [1, 0, 0], [0, 1, 0]), BLACK) | {"luminaire": _wall(luminance)}
    sensor = _meters({"name": "air", "points": points, "measures": "fluence"})
    found = _read({"sensor": sensor, "surfaces": [shining]}, tmp_path, 1024, seeds=4)
    known = [
        luminance * sum(_solid_angle(u, v, z) for u in (x, 1.0 - x) for v in (y, 1.0 - y))
        for x, y, z in points
    ]
    for reading, truth in zip(found, known, strict=True):
        reading.check(truth, 1e-4, len(points))
    mean = float(np.dot(shares, [reading.mean for reading in found]))
    # Five nodes along each axis are enough for 2e-3.
    assert mean == pytest.approx(pi * luminance * 2.0 / 3.0, rel=4e-3)


def test_faces_of_a_box_around_a_lamp(tmp_path: Path) -> None:
    """From inside: I cos / d^2 in the middles of its six sides, which have other distances each; and on the
    mean over points that stand for equal areas the lamp's flux over the whole area, as all of it arrives."""
    low, high = [-1.0, -1.5, -2.0], [2.0, 1.0, 1.5]
    box = {"name": "box", "shape": {"type": "box", "minimum": low, "maximum": high}, "kernel": BLACK}
    lamp = {
        "shape": sphere([0.0, 0.0, 0.0], 0.001),
        "kernel": BLACK,
        "luminaire": {"radiance": {"illuminant": "D65"}, "lumens": LUMENS},
    }
    sides = {"surface": "box", "side": "back"}
    sensor = _meters(
        {"name": "sides", "faces": {**sides, "count": 6}},
        {"name": "spread", "faces": {**sides, "count": 1200, "spread": True}},
    )
    document = {"nocturne": 1, "sensor": sensor, "surfaces": [box, lamp]}
    image = Measurement(document, tmp_path, 1200, 2).image(256).y
    middle, half = (np.array(low) + high) / 2, (np.array(high) - low) / 2
    for index in range(6):
        axis, sign = index // 2, 1.0 if index % 2 else -1.0
        place = middle.copy()
        place[axis] += sign * half[axis]
        towards = sign * place[axis] / np.linalg.norm(place)
        truth = LUMENS / (4.0 * pi) * towards / float(place @ place)
        assert image[0, index] == pytest.approx(truth, rel=0.01)
    a, b, c = 2.0 * half
    assert float(image[1].mean()) == pytest.approx(LUMENS / (2.0 * (a * b + b * c + c * a)), rel=5e-3)


def test_faces_of_a_mesh_file_under_an_even_sky(tmp_path: Path) -> None:
    """A roof of two slopes: E_h (1 + cos t) / 2 at a tilt of t, where the sky is even and the ground dark."""
    (tmp_path / "roof.obj").write_text(
        "v 0 0 0\nv 3 0 0\nv 3 3 3\nv 0 3 3\nv 0 0 5\nv 3 0 5\nf 1 3 2\nf 1 4 3\nf 4 6 3\nf 4 5 6\n"
    )
    document = {
        "nocturne": 1,
        "sensor": _meters({"name": "roof", "faces": {"surface": "roof", "count": 4}}),
        "surfaces": [{"name": "roof", "shape": {"type": "mesh", "asset": "roof.obj"}, "kernel": BLACK}],
        "environment": {"cie": 5, "illuminance": 10000},
    }
    image = Measurement(document, tmp_path, 4, 1).image(1024).y
    slopes = [3.0 / hypot(3.0, 3.0)] * 2 + [2.0 / hypot(3.0, 2.0)] * 2
    for found, cosine in zip(image[0], slopes, strict=True):
        assert found == pytest.approx(10000.0 * (1.0 + cosine) / 2.0, rel=0.02)


def test_a_grid_is_its_plan(tmp_path: Path) -> None:
    """A lamp above the right end of the upper edge lights the pixel there most: +x right, +y up."""
    lamp = {
        "shape": sphere([2.0, 0.5, -1.0], 0.01),
        "kernel": BLACK,
        "luminaire": {"radiance": {"illuminant": "D65"}, "lumens": LUMENS},
    }
    grid = {"corner": [0, 0, 0], "right": [2, 0, 0], "up": [0, 0, -1], "columns": 4, "rows": 2}
    document = {"nocturne": 1, "sensor": _meters({"name": "floor", "grid": grid}), "surfaces": [lamp]}
    image = Measurement(document, tmp_path, 4, 2).image(256).y
    assert image.shape == (2, 4)
    assert divmod(int(image.argmax()), 4) == (0, 3)
    for row in range(2):
        for column in range(4):
            x, z = 0.25 + 0.5 * column, -0.75 + 0.5 * row
            d2 = (x - 2.0) ** 2 + 0.25 + (z + 1.0) ** 2
            truth = LUMENS / (4.0 * pi) * 0.5 / d2**1.5
            assert image[row, column] == pytest.approx(truth, rel=0.02)
