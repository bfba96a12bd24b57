"""4 x 4 matrices of column vectors, as scene formats compose them."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Matrices = NDArray[np.float64]
"""Many, shape (n, 4, 4); their last rows need not be there."""

IDENTITY: Matrix = np.eye(4)


def translation(shift: Sequence[float]) -> Matrix:
    """Shift by (x, y, z)."""
    matrix = np.eye(4)
    matrix[:3, 3] = shift
    return matrix


def scaling(factors: Sequence[float]) -> Matrix:
    """Scale by (x, y, z)."""
    return np.diag([*factors, 1.0])


def rotation(axis: Sequence[float], degrees: float) -> Matrix:
    """Right-handed about an axis through the origin (Rodrigues). ValueError for an axis without length."""
    a = np.array(axis, dtype=np.float64)
    length = float(np.linalg.norm(a))
    if not length > 0:
        raise ValueError("the axis has no length")
    x, y, z = a / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)
    return matrix


def inverse(matrix: Matrix) -> Matrix:
    """The inverse matrix."""
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


EVEN = 1e-4
"""Relative difference of squared lengths up to which a scale counts as even: matrices of six decimals are not
exact."""


def similarity(matrix: Matrix) -> float | None:
    """The factor of all lengths if the matrix only turns, shifts and scales evenly; else None."""
    linear = matrix[:3, :3]
    square = linear.T @ linear
    factor = float(np.trace(square)) / 3
    if not factor > 0 or np.abs(square - factor * np.eye(3)).max() > EVEN * factor:
        return None
    return math.sqrt(factor)


def is_mirrored(matrix: Matrix) -> bool:
    """Whether the matrix turns left hands into right ones."""
    return bool(np.linalg.det(matrix[:3, :3]) < 0)


def even_factors(matrices: Matrices) -> NDArray[np.float64]:
    """The factor of all lengths of each, if it is the same for all; shape (n,)."""
    linear = matrices[:, :3, :3]
    return np.asarray(np.sqrt(np.einsum("nij,nij->n", linear, linear) / 3))


def are_even(matrices: Matrices) -> NDArray[np.bool_]:
    """Whether each only turns, shifts and scales evenly, as instances may, and mirrors nothing."""
    linear = matrices[:, :3, :3]
    square = np.einsum("nki,nkj->nij", linear, linear)
    factors = even_factors(matrices) ** 2
    apart = np.abs(square - factors[:, None, None] * np.eye(3)).max(axis=(1, 2))
    return np.asarray((factors > 0) & (apart <= EVEN * factors) & (np.linalg.det(linear) > 0))


def is_even(matrix: Matrix) -> bool:
    """The same of one, in half of the time: a scene may have a million, which come one by one."""
    return similarity(matrix) is not None and not is_mirrored(matrix)


def rotations_of(linear: Matrices) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Axes, shape (n, 3), and degrees, shape (n,), of 3 x 3 rotations; zeros where it is the identity."""
    # Late: it takes longer to import than all else that commands need which take a scene of any format.
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_matrix(linear).as_rotvec()
    angles = np.linalg.norm(turns, axis=1)
    angles[angles < 1e-12] = 0.0
    return turns / np.where(angles > 0, angles, np.inf)[:, None], np.degrees(angles)


def rotation_of(linear: Matrix) -> tuple[list[float], float] | None:
    """Axis and degrees of a 3 x 3 rotation; None if it is the identity."""
    axes, degrees = rotations_of(linear[None])
    return (axes[0].tolist(), float(degrees[0])) if degrees[0] else None


def look_at(origin: Sequence[float], target: Sequence[float], up: Sequence[float]) -> Matrix:
    """From a camera's coordinates (x left, y up, z ahead) to the scene's. ValueError without directions."""
    ahead = np.subtract(target, origin).astype(np.float64)
    if not np.linalg.norm(ahead) > 0:
        raise ValueError("target and origin are the same point")
    ahead /= np.linalg.norm(ahead)
    left = np.cross(up, ahead)
    if not np.linalg.norm(left) > 1e-12:
        raise ValueError("up has no direction across the view")
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([left, np.cross(ahead, left), ahead])
    matrix[:3, 3] = origin
    return matrix
