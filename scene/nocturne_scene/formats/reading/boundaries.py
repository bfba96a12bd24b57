"""Boundaries of glass as Mitsuba and pbrt know them: between two indices, whatever surrounds them.

Our bodies know what they are in, and of overlapping ones a priority decides. A body by itself is the same in
both. Where the boxes of several bodies overlap (ice in water in a glass, a bubble, an open sheet of water
above a tank) each surface becomes a boundary between its two indices.
"""

import json
from collections.abc import Iterator
from copy import deepcopy

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter

_Box = NDArray[np.float64]
_EVERYWHERE: _Box = np.array([[-np.inf] * 3, [np.inf] * 3])
"""Of shapes that are not looked at: instances, placements in files, planes."""
_INNER = ("first", "second", "front", "back", "kernel")
"""Fields of kernels that hold others."""


def between_indices(writer: SceneWriter, findings: Findings) -> None:
    """Give the dielectrics of a document that is done an index outside, where they need one."""
    document = writer.document
    glass = [
        (surface, _box(writer, surface, in_scene))
        for surfaces, in_scene in _lists(document)
        for surface in surfaces
        if any(_dielectrics(document, surface.get("kernel")))
    ]
    for surface, _ in glass:
        if "interior" in surface:
            _make_body(document, surface, findings)
    bounding_nothing = [
        surface
        for (surface, _), overlaps in zip(glass, _overlapping([box for _, box in glass]), strict=True)
        if overlaps and "interior" not in surface
    ]
    unchanged = {id(surface) for surface, _ in glass} - {id(surface) for surface in bounding_nothing}
    bodies = {json.dumps(surface["kernel"]) for surface, _ in glass if id(surface) in unchanged}
    for surface in bounding_nothing:
        kernel = surface["kernel"]
        if isinstance(kernel, str) and json.dumps(kernel) not in bodies:
            document["kernels"][kernel] = _bounding_nothing(document, document["kernels"][kernel])
        else:
            surface["kernel"] = _bounding_nothing(document, kernel)


def _lists(document: Json) -> Iterator[tuple[list[Json], bool]]:
    yield document.get("surfaces", []), True
    for members in document.get("groups", {}).values():
        yield members, False


def _dielectrics(document: Json, kernel: Json) -> Iterator[Json]:
    if isinstance(kernel, str):
        kernel = document.get("kernels", {}).get(kernel)
    if not isinstance(kernel, dict):
        return
    if kernel.get("type") == "dielectric":
        yield kernel
    for name in _INNER:
        yield from _dielectrics(document, kernel.get(name))


def _box(writer: SceneWriter, surface: Json, in_scene: bool) -> _Box:
    shape = surface["shape"]
    if not in_scene or "placements" in surface or "motion" in surface:
        return _EVERYWHERE
    if shape["type"] == "sphere":
        centre, radius = np.array(shape["centre"], dtype=np.float64), shape["radius"]
        return np.stack([centre - radius, centre + radius])
    return writer.boxes.get(shape.get("asset", ""), _EVERYWHERE)


def _overlapping(boxes: list[_Box]) -> list[bool]:
    """Of each box whether it meets another one; a scene may have thousands."""
    corners = np.array(boxes).reshape(-1, 2, 3)
    low, high = corners[:, 0], corners[:, 1]
    # Each meets itself.
    return [int(np.count_nonzero(np.all((low <= box[1]) & (box[0] <= high), axis=1))) > 1 for box in corners]


def _resolved(document: Json, kernel: Json) -> Json:
    """A copy of a kernel in which no dielectric goes by a name."""
    if not any(_dielectrics(document, kernel)):
        return kernel
    own = deepcopy(document["kernels"][kernel] if isinstance(kernel, str) else kernel)
    return own | {name: _resolved(document, own[name]) for name in _INNER if name in own}


def _bounding_nothing(document: Json, kernel: Json) -> Json:
    found = _resolved(document, kernel)
    for dielectric in _dielectrics(document, found):
        dielectric.setdefault("outside", 1.0)
    return found


def _make_body(document: Json, surface: Json, findings: Findings) -> None:
    """What holds media bounds a body, which has one index."""
    if not any("outside" in each for each in _dielectrics(document, surface["kernel"])):
        return
    surface["kernel"] = _resolved(document, surface["kernel"])
    for dielectric in _dielectrics(document, surface["kernel"]):
        outside = dielectric.pop("outside", None)
        if outside is not None:
            findings.note(
                "$.surfaces",
                f"a boundary of indices {dielectric['index']:g} and {outside:g} that encloses media became "
                "one of their ratio",
            )
            dielectric["index"] /= outside
