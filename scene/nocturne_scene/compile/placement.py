"""Where things stand and how they move: scale, then rotation, then shift, in float64."""

import math

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.document import bounds
from nocturne_scene.document.placement import KeyedMotion, Motion, Moving, Placement, RigidMotion, Rotation
from nocturne_scene.meshes.similarity import IDENTITY, Similarity


def placement_of(placement: Placement) -> Similarity:
    """Return where a part of the document stands when the shutter opens, without its motion."""
    rotation = np.eye(3) if placement.rotate is None else _matrix(placement.rotate)
    return Similarity(placement.scale, rotation, np.array(placement.translate))


def placements_of(moving: Moving) -> list[Similarity]:
    """Return where a part of the document stands at equally spaced times; one entry: it is at rest."""
    own = placement_of(moving)
    return [moved.after(own) for moved in motion_steps(moving.motion)]


def motion_steps(motion: Motion | None) -> list[Similarity]:
    """Return a motion at equally spaced times, ends included; one entry: nothing moves."""
    match motion:
        case None:
            return [IDENTITY]
        case KeyedMotion():
            steps = [placement_of(placement) for placement in motion.placements]
            return steps if any(_differ(step, steps[0]) for step in steps) else steps[:1]
        case RigidMotion():
            return _rigid(motion)


def _differ(one: Similarity, other: Similarity) -> bool:
    return not np.array_equal(one.rows(), other.rows())


def _rigid(motion: RigidMotion) -> list[Similarity]:
    degrees = 0.0 if motion.rotate is None else motion.rotate.degrees
    shift = np.array(motion.translate)
    if degrees == 0 and not np.any(shift):
        return [IDENTITY]
    pieces = max(1, math.ceil(abs(degrees) / largest_piece()))
    steps = []
    for time in np.arange(pieces + 1) / pieces:
        turn = IDENTITY
        if motion.rotate is not None:
            about = np.array(motion.rotate.about)
            matrix = _matrix(Rotation(axis=motion.rotate.axis, degrees=degrees * float(time)))
            turn = Similarity(1.0, matrix, about - about @ matrix.T)
        steps.append(Similarity(1.0, turn.rotation, turn.shift + time * shift))
    return steps


def largest_piece() -> float:
    """Return the degrees of an arc whose chord stays within the bound of it: r - r cos(a / 2)."""
    return math.degrees(2 * math.acos(1 - bounds.ARC_DEVIATION))


def _matrix(rotation: Rotation) -> NDArray[np.float64]:
    """Rodrigues' formula: R = I + sin(a) K + (1 - cos(a)) K^2, K v = axis x v. Quarter turns are exact."""
    x, y, z = np.array(rotation.axis) / np.linalg.norm(rotation.axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = _sine_cosine(rotation.degrees)
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross), dtype=np.float64)


def _sine_cosine(degrees: float) -> tuple[float, float]:
    quarters = degrees / 90
    if quarters == int(quarters):
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[int(quarters) % 4]
    radians = np.deg2rad(degrees)
    return float(np.sin(radians)), float(np.cos(radians))
