"""Bodies of any thickness, and lamps close behind what lets light through.

A closed body that absorbs nothing cannot be seen in even light. Each group of photons brings back 1, so every
pixel is 1 to rounding, and one that stepped over a face would be 0.44 or 2.25: no statistics.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK, box, diffuse, measured_scene, quad, surface

from tests.accuracy.meters import Measurement, check_equal
from tests.accuracy.tracing import IN_FULL, Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_WIDTH = 2.0
_THICKNESSES = (1e-1, 1e-3, 1e-5, 1e-6, 1e-7)
"""Parts of the width."""
_DISTANCES = (1.0, 5e3, 1e5)
_TURNED: Document = {"rotate": {"axis": [1.0, 0.3, 0.2], "degrees": 33.0}}
_ABSORBED = 1e-5
"""Of the optical depth of what absorbs: its darkness is below the tolerance at any angle."""
_TOLERANCE = 1e-3
_SAMPLES, _EDGE = 8, 8
_EVEN: dict[str, Any] = {"estimator": "mixture", "mixture": {"kernel": 1.0, "environment": 0.0}, "h": 1e6}
"""No photon is aimed or dies."""


def _dished(thickness: float, cells: int = 24) -> Document:
    """A square plate, both of whose faces are the same paraboloid."""
    line = np.linspace(-0.5 * _WIDTH, 0.5 * _WIDTH, cells + 1)
    x, y = (each.ravel() for each in np.meshgrid(line, line, indexing="ij"))
    z = 0.25 * (x**2 + y**2)
    vertices = np.concatenate([np.column_stack([x, y, z + thickness]), np.column_stack([x, y, z])])
    face = (cells + 1) ** 2

    def at(i: int, j: int) -> int:
        return i * (cells + 1) + j

    triangles = []
    for i in range(cells):
        for j in range(cells):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [[a, b, c], [a, c, d]]
            triangles += [[face + a, face + c, face + b], [face + a, face + d, face + c]]
    rim = [at(i, 0) for i in range(cells)] + [at(cells, j) for j in range(cells)]
    rim += [at(i, cells) for i in range(cells, 0, -1)] + [at(0, j) for j in range(cells, 0, -1)]
    for a, b in zip(rim, rim[1:] + rim[:1], strict=True):
        triangles += [[a, face + a, b], [b, face + a, face + b]]
    return {"type": "mesh", "vertices": vertices.tolist(), "triangles": triangles}


def _filled(material: str, thickness: float, shape: Document) -> tuple[Document, Document]:
    """The body, and the scene's media: an optical depth of 1 across, where there is any."""
    fog = {"media": {"fog": {"scattering": 1.0 / thickness, "absorption": 0.0}}}
    glass = {"type": "dielectric", "index": 1.5}
    if material == "glass":
        return {"shape": shape, "kernel": glass}, {}
    if material == "absorbing glass":
        return {"shape": shape, "kernel": glass | {"absorption": _ABSORBED / thickness}}, {}
    body: Document = {"shape": shape, "interior": {"media": ["fog"]}}
    return (body if material == "fog" else body | {"kernel": glass | {"index": 1.33}}), fog


def _neighbours(form: str, thickness: float) -> list[Document]:
    """A thousandth of the thickness away: glass above, below a dim lamp that light passes."""
    gap, half = 1e-3 * thickness, 0.45 * _WIDTH
    above = box([-half, -half, 0.5 * thickness + gap], [half, half, 0.5 * thickness + 0.1])
    below = quad([-half, -half, -0.5 * thickness - gap], [2 * half, 0, 0], [0, 2 * half, 0])
    if form == "curved":
        above = _raised(_dished(0.1), thickness + gap)
        below = _raised(_dished(0.1), -gap)
        face = len(below["vertices"]) // 2
        below["triangles"] = [each for each in below["triangles"] if min(each) >= face]
    return [
        {"shape": above, "kernel": {"type": "dielectric", "index": 1.7}},
        {"shape": below, "kernel": {"type": "null"}, "luminaire": {"radiance": 1e-9}},
    ]


def _raised(mesh: Document, height: float) -> Document:
    return mesh | {"vertices": [[x, y, z + height] for x, y, z in mesh["vertices"]]}


def _scene(material: str, form: str, thickness: float, near: bool) -> Document:
    half = 0.5 * _WIDTH
    flat = box([-half, -half, -0.5 * thickness], [half, half, 0.5 * thickness])
    body, media = _filled(material, thickness, _dished(thickness) if form == "curved" else flat)
    surfaces = [body, *(_neighbours(form, thickness) if near else [])]
    document: Document = {"environment": {"radiance": 1.0}, "surfaces": surfaces, **media}
    if form == "turned":
        document["surfaces"] = [each | _TURNED for each in surfaces]
    elif form == "moving":
        document["surfaces"] = [each | {"motion": {"translate": [0.0, 0.0, 0.01]}} for each in surfaces]
    elif form == "instanced":
        document |= {"surfaces": [], "groups": {"plate": surfaces}}
        document["instances"] = [{"group": "plate", **_TURNED}]
    return document


def _seen_from(distance: float) -> Document:
    """A camera that sees half of the body, askew."""
    direction = np.array([0.3, 0.2, 0.93]) / np.linalg.norm([0.3, 0.2, 0.93])
    return {
        "type": "pinhole",
        "position": (distance * direction).tolist(),
        "look_at": [0.0, 0.0, 0.0],
        "vertical_field_of_view_degrees": float(np.degrees(2.0 * np.arctan(0.25 * _WIDTH / distance))),
    }


_FORMS = ("flat", "turned", "instanced", "curved", "moving")
_CASES = [(form, near) for near in (False, True) for form in _FORMS]


@pytest.mark.parametrize(("form", "near"), _CASES)
@pytest.mark.parametrize("material", ["glass", "absorbing glass", "fog", "milk"])
def test_cannot_be_seen(material: str, form: str, near: bool, tmp_path: Path) -> None:
    """Of any thickness, from any distance, with and without something close to either face.

    `make test` sees each thickness from one distance: over the forms, from all of them. Turned or curved, a
    gap of a thousandth of less than 1e-5 is no number of vertices as floats: surfaces then lie on each other,
    or cross each other.
    """
    for i, part in enumerate(_THICKNESSES):
        document = measured_scene({}, [], **_EVEN) | _scene(material, form, part * _WIDTH, near)
        turn = (i + _CASES.index((form, near))) % len(_DISTANCES)
        for distance in _DISTANCES if IN_FULL else _DISTANCES[turn : turn + 1]:
            document["sensor"] = {**document["sensor"], **_seen_from(distance)}
            folder = tmp_path / f"{i} {distance:g}"
            folder.mkdir()
            image = Measurement(document, folder, _EDGE, _EDGE).image(_SAMPLES)
            read = image.further["grey"].astype(np.float64) / (830.0 - 360.0)
            assert read == pytest.approx(np.ones_like(read), abs=_TOLERANCE), (part, distance)


def test_a_window_far_from_the_origin(tmp_path: Path) -> None:
    """A pane of 4 mm, 5 km from a sensor that stands at the origin."""
    pane = {"shape": box([-1, -1, 5000.0], [1, 1, 5000.004]), "kernel": {"type": "dielectric", "index": 1.5}}
    camera = {
        "type": "pinhole",
        "position": [0, 0, 0],
        "look_at": [0, 0, 5000],
        "vertical_field_of_view_degrees": 0.01,
    }
    document = measured_scene(camera, [pane], **_EVEN) | {"environment": {"radiance": 1.0}}
    read = Measurement(document, tmp_path, _EDGE, _EDGE).image(_SAMPLES).further["grey"] / (830.0 - 360.0)
    assert read == pytest.approx(np.ones_like(read), abs=_TOLERANCE)


_BEFORE: dict[str, Document] = {
    "pane": {"kernel": {"type": "dielectric", "index": 1.5}},
    "mask": {"kernel": {"type": "mask", "kernel": diffuse(0.3), "opacity": 0.5}},
    "null kernel": {"kernel": {"type": "null"}},
    "null lamp": {"kernel": {"type": "null"}, "luminaire": {"radiance": 1.0}},
    "paper": {"kernel": {"type": "diffuse_transmitter", "reflectance": 0.4, "transmittance": 0.5}},
}


@pytest.mark.parametrize("direction", ["adjoint", "both"])
@pytest.mark.parametrize("name", _BEFORE)
def test_a_lamp_behind(name: str, direction: str, tmp_path: Path) -> None:
    """A lamp of 200 m close behind a body of its width gives the same reading as 20 mm behind it.

    z within the bound of Student's t for all gaps; false alarms 0.01.
    """
    width, gaps = 200.0, (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    corner, edges = [-0.5 * width, -0.5 * width], ([width, 0, 0], [0, width, 0])
    before = {"shape": quad([*corner, 0.0], *edges), **_BEFORE[name]}
    if name == "pane":
        before["shape"] = box([*corner, 0.0], [0.5 * width, 0.5 * width, 0.004])
    floor = surface(quad([-width, -width, 0.7 * width], [0, 2 * width, 0], [2 * width, 0, 0]), diffuse(0.6))
    camera = {
        "type": "pinhole",
        "position": [10.0, 4.0, 70.0],
        "look_at": [20.0, 26.0, 0.0],
        "vertical_field_of_view_degrees": 20,
    }
    readings = []
    for i, gap in enumerate(gaps):
        folder = tmp_path / str(i)
        folder.mkdir()
        lamp = surface(quad([*corner, -gap * width], *edges), BLACK, 1.0)
        document = measured_scene(camera, [lamp, before, floor], direction=direction)
        readings.append(Measurement(document, folder, 8, 8).by_seeds(32))
    for reading in readings[1:]:
        check_equal(readings[0], reading, values=len(gaps) - 1)
