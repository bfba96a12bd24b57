"""4 x 4 matrices of column vectors, as scene formats compose them."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

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
    """The way back."""
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def similarity(matrix: Matrix) -> float | None:
    """The factor of all lengths if the matrix only turns, shifts and scales evenly; else None."""
    linear = matrix[:3, :3]
    square = linear.T @ linear
    factor = float(np.trace(square)) / 3
    if not factor > 0 or np.abs(square - factor * np.eye(3)).max() > 1e-6 * factor:
        return None
    return math.sqrt(factor)


def is_mirrored(matrix: Matrix) -> bool:
    """Whether the matrix turns left hands into right ones."""
    return bool(np.linalg.det(matrix[:3, :3]) < 0)


def rotation_of(linear: Matrix) -> tuple[list[float], float] | None:
    """Axis and degrees of a 3 x 3 rotation; None if it is the identity."""
    # Late: it takes longer to import than all else that commands need which take a scene of any format.
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(linear).as_rotvec()
    angle = float(np.linalg.norm(turn))
    return None if angle < 1e-12 else ((turn / angle).tolist(), math.degrees(angle))


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
