"""Documents in which nothing moves."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import TypeAdapter
from scipy.spatial.transform import Rotation

from nocturne_scene.compile.placement import motion_steps, placement_of
from nocturne_scene.document.placement import KeyedMotion, Motion, RigidMotion
from nocturne_scene.meshes.similarity import Similarity
from nocturne_scene.simplify.simplification import Document, Simplification, objects

_MOTION: TypeAdapter[Any] = TypeAdapter(Motion)


def frozen(document: Document) -> Iterator[Simplification]:
    """Everything where it is when half of the shutter's time has passed."""
    if any(_moves(each) for each in objects(document)):
        yield Simplification("nothing moves", _freeze)


def _moves(value: Document) -> bool:
    motion = value.get("motion")
    return isinstance(motion, dict) and (
        "translate" in motion or "rotate" in motion or "placements" in motion
    )


def _freeze(document: Document) -> None:
    for each in objects(document):
        if _moves(each):
            placement = _middle(_MOTION.validate_python(each["motion"]))
            # Twice the same: the compiler knows that as rest, and a thing's own placement stays as it is.
            each["motion"] = {"placements": [placement, placement]}


def _middle(motion: RigidMotion | KeyedMotion) -> Document:
    """The placement at half of the time. Between two given ones that differ by more than a shift it is the
    later one: points move in straight lines there, which is no placement."""
    if isinstance(motion, RigidMotion):
        turn = motion.rotate and motion.rotate.model_copy(update={"degrees": motion.rotate.degrees / 2})
        x, y, z = motion.translate
        return _written(motion_steps(RigidMotion(rotate=turn, translate=(x / 2, y / 2, z / 2)))[-1])
    steps = [placement_of(each) for each in motion.placements]
    middle, before = steps[len(steps) // 2], steps[(len(steps) - 1) // 2]
    if np.array_equal(before.rotation, middle.rotation) and before.scale == middle.scale:
        return _written(Similarity(middle.scale, middle.rotation, 0.5 * (before.shift + middle.shift)))
    return _written(middle)


def _written(step: Similarity) -> Document:
    placement: Document = {"translate": step.shift.tolist()}
    if step.scale != 1.0:
        placement["scale"] = float(step.scale)
    turn = Rotation.from_matrix(step.rotation).as_rotvec(degrees=True)
    degrees = float(np.linalg.norm(turn))
    if degrees > 0.0:
        placement["rotate"] = {"axis": (turn / degrees).tolist(), "degrees": degrees}
    return placement
