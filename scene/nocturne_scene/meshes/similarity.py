"""How meshes and grids are placed: scaled, then turned, then shifted, in float64."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Similarity:
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

    def turned(self, directions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rotate directions, shape (..., 3), and keep their lengths."""
        return np.asarray(directions @ self.rotation.T, dtype=np.float64)

    def after(self, first: "Similarity") -> "Similarity":
        """Return the similarity that does `first` and then this."""
        return Similarity(self.scale * first.scale, self.rotation @ first.rotation, self.points(first.shift))

    def rows(self) -> NDArray[np.float64]:
        """Return the 3 x 4 matrix, shape (3, 4)."""
        return np.concatenate([self.scale * self.rotation, self.shift[:, None]], axis=1)


IDENTITY = Similarity(1.0, np.eye(3), np.zeros(3))
