"""Closed bodies of triangles and spheres: whether points are inside, and of what parts they consist."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

_WELDED = 1e-6
"""Of a body's size: corners closer than this are one."""

_SAMPLES = 100
"""Points of a body's boundary that are looked at, about."""

_CLEARLY = 0.1
"""Parts of a turn by which a point is clearly inside or outside: on a face it is half a turn."""


@dataclass(frozen=True)
class Body:
    """The boundary of a body: a sphere, or triangles."""

    corners: Points
    """Of the triangles, shape (n, 3, 3); of a sphere none."""
    centre: Points
    """Of a sphere."""
    radius: float = 0.0
    """0: it consists of triangles."""

    @classmethod
    def of(cls, corners: Points) -> "Body":
        """Of triangles."""
        return cls(corners, np.zeros(3))

    def boundary(self) -> Points:
        """Some points of it, shape (n, 3)."""
        if self.radius:
            # Evenly, by the golden angle.
            z = 1.0 - (2.0 * np.arange(_SAMPLES) + 1.0) / _SAMPLES
            turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(_SAMPLES)
            ring = np.sqrt(1.0 - z * z)
            directions = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=-1)
            return np.asarray(self.centre + self.radius * directions, dtype=np.float64)
        points = np.concatenate([self.corners.reshape(-1, 3), self.corners.mean(axis=1)])
        return points[:: max(1, len(points) // _SAMPLES)]

    def sides(self, points: Points) -> tuple[bool, bool]:
        """Whether any of the points is clearly inside of it, and whether any is clearly outside."""
        if self.radius:
            distances = np.linalg.norm(points - self.centre, axis=-1) / self.radius
            return bool((distances < 1.0 - _WELDED).any()), bool((distances > 1.0 + _WELDED).any())
        turns = np.abs(winding(self.corners, points))
        return bool((turns > 1.0 - _CLEARLY).any()), bool((turns < _CLEARLY).any())

    def box(self) -> tuple[Points, Points]:
        """Opposite corners of a box around it."""
        if self.radius:
            return self.centre - self.radius, self.centre + self.radius
        points = self.corners.reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)


def cross(one: Body, other: Body) -> bool:
    """Whether the boundary of one is partly inside of the other and partly not; bodies that touch do not."""
    (low, high), (other_low, other_high) = one.box(), other.box()
    if (low >= other_high).any() or (other_low >= high).any():
        return False
    return all(other.sides(one.boundary())) or all(one.sides(other.boundary()))


def within(one: Body, other: Body) -> bool:
    """Whether all of one's boundary is inside of the other."""
    (low, high), (other_low, other_high) = one.box(), other.box()
    if (low <= other_low).any() or (high >= other_high).any():
        return False
    return other.sides(one.boundary()) == (True, False)


def winding(corners: Points, points: Points) -> Points:
    """How often triangles turn around points: 1 or -1 inside of a closed body, 0 outside.

    Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle" (1983).
    """
    a, b, c = (corners[None, :, index] - points[:, None] for index in range(3))
    lengths = [np.linalg.norm(each, axis=-1) for each in (a, b, c)]
    volume = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    dots = [np.einsum("ijk,ijk->ij", one, other) for one, other in ((a, b), (b, c), (c, a))]
    below = (
        lengths[0] * lengths[1] * lengths[2]
        + dots[0] * lengths[2]
        + dots[1] * lengths[0]
        + dots[2] * lengths[1]
    )
    return np.asarray(2.0 * np.arctan2(volume, below).sum(axis=-1) / (4.0 * math.pi), dtype=np.float64)


def welded(corners: Points) -> NDArray[np.int64]:
    """The triangles' corners by number, equal where they are one, shape (n, 3)."""
    points = corners.reshape(-1, 3)
    points = points - points.min(axis=0)
    # Up to 10^6 each, so that three of them are one whole number.
    places = np.rint(points / (_WELDED * float(points.max()))).astype(np.int64)
    _, names = np.unique(places @ np.array([1 << 42, 1 << 21, 1]), return_inverse=True)
    return names.reshape(-1, 3)


def open_edges(corners: Points) -> int:
    """Edges that an odd number of triangles have."""
    names = welded(corners)
    ends = np.sort(np.concatenate([names[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    ends = ends[ends[:, 0] != ends[:, 1]]
    _, counts = np.unique(ends @ np.array([names.max() + 1, 1]), return_counts=True)
    return int(np.count_nonzero(counts % 2))


def parts(corners: Points) -> NDArray[np.int64]:
    """For each triangle the number of the part that it belongs to: triangles that share a corner."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    names = welded(corners)
    ends = np.concatenate([names[:, :2], names[:, 1:]])
    count = int(names.max()) + 1
    graph = coo_array((np.ones(len(ends), dtype=np.int8), (ends[:, 0], ends[:, 1])), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    return np.asarray(labels[names[:, 0]], dtype=np.int64)
