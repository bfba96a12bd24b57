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
    # The quaternion's largest component is found first, so that half turns are exact too.
    trace = float(np.trace(linear))
    diagonal = np.diag(linear)
    squares = np.array([1 + trace, *(1 + 2 * diagonal - trace)]) / 4
    largest = int(np.argmax(squares))
    w, x, y, z = (0.0, 0.0, 0.0, 0.0)
    q = math.sqrt(max(0.0, float(squares[largest])))
    m = linear
    match largest:
        case 0:
            w, x, y, z = (
                q,
                (m[2, 1] - m[1, 2]) / (4 * q),
                (m[0, 2] - m[2, 0]) / (4 * q),
                (m[1, 0] - m[0, 1]) / (4 * q),
            )
        case 1:
            w, x, y, z = (
                (m[2, 1] - m[1, 2]) / (4 * q),
                q,
                (m[0, 1] + m[1, 0]) / (4 * q),
                (m[0, 2] + m[2, 0]) / (4 * q),
            )
        case 2:
            w, x, y, z = (
                (m[0, 2] - m[2, 0]) / (4 * q),
                (m[0, 1] + m[1, 0]) / (4 * q),
                q,
                (m[1, 2] + m[2, 1]) / (4 * q),
            )
        case _:
            w, x, y, z = (
                (m[1, 0] - m[0, 1]) / (4 * q),
                (m[0, 2] + m[2, 0]) / (4 * q),
                (m[1, 2] + m[2, 1]) / (4 * q),
                q,
            )
    sine = math.sqrt(x * x + y * y + z * z)
    if sine < 1e-12:
        return None
    return [float(x / sine), float(y / sine), float(z / sine)], math.degrees(2 * math.atan2(sine, w))


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
