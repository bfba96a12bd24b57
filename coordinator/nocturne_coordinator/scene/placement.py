"""Where a surface stands: scale, then rotation, then shift, in float64."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_coordinator.scene.model import Surface
from nocturne_coordinator.scene.shape_model import Rotation


@dataclass(frozen=True)
class Placement:
    """x -> scale R x + shift, with a rotation R."""

    scale: float
    rotation: NDArray[np.float64]
    shift: NDArray[np.float64]

    def points(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Place points, shape (..., 3)."""
        return self.directions(points) + self.shift

    def directions(self, directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Place differences of points, shape (..., 3): no shift."""
        return np.asarray(self.scale * directions @ self.rotation.T, dtype=np.float64)


def placement_of(surface: Surface) -> Placement:
    """Return the placement that a surface of the document asks for."""
    rotation = np.eye(3) if surface.rotate is None else _matrix(surface.rotate)
    return Placement(surface.scale, rotation, np.array(surface.translate))


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
