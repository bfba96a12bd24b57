"""Outlines of a scene in a plan: walls that a plane cuts, edges below it, and luminaires."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from nocturne.v1 import scene_pb2
from nocturne_scene.formats.writing.compiled import Compiled
from nocturne_scene.meshes.triangles import area_vectors
from nocturne_scene.photometry.places import Part
from numpy.typing import NDArray

Values = NDArray[np.float64]
Segment = tuple[float, float, float, float]
"""From x, y to x, y in the plan, m."""

_FLAT = np.cos(np.deg2rad(25.0))
"""Between faces that are more even than that there is no line."""
_MOST = 400_000
"""Triangles of one surface beyond which it is left out."""
_SAME = 1e-4
"""m."""
_ROUND = 48


@dataclass(frozen=True)
class Frame:
    """Axes of a plan."""

    origin: Values
    """Its lower left corner, m."""
    right: Values
    up: Values
    normal: Values
    """Unit vectors; the last one points towards who looks at the plan."""
    width: float
    height: float
    """m."""

    @classmethod
    def of(cls, part: Part) -> "Frame":
        """Of an instrument's grid or a film."""
        across, up = np.array(part.across), -np.array(part.down)
        corner = np.array(part.first) - 0.5 * across + (0.5 - part.rows) * up
        right, upwards = across / np.linalg.norm(across), up / np.linalg.norm(up)
        normal = np.cross(right, upwards)
        width, height = part.columns * np.linalg.norm(across), part.rows * np.linalg.norm(up)
        return cls(corner, right, upwards, normal / np.linalg.norm(normal), float(width), float(height))

    def seen(self, points: Values) -> Values:
        """x, y in the plan and the height over the plane, m."""
        return (points - self.origin) @ np.stack([self.right, self.up, self.normal]).T


@dataclass
class PlanLines:
    """Lines of walls, of things below, and of luminaires."""

    cut: set[Segment] = field(default_factory=set)
    below: set[Segment] = field(default_factory=set)
    lamps: set[Segment] = field(default_factory=set)


def plan_lines(compiled: Compiled, frame: Frame, shift: Values) -> PlanLines:
    """`shift`: where the compiled scene's origin is in the document, m."""
    found = PlanLines()
    lamps = {each.surface for each in compiled.message.luminaires}
    for at, surface, placement in _placed(compiled):
        if surface.WhichOneof("shape") == "sphere":
            centre, radius = compiled.sphere(surface.sphere, "")
            middle = frame.seen(placement[:, :3] @ centre + placement[:, 3] + shift)
            size = radius * float(np.linalg.norm(placement[:, 0]))
            _add_round(found, middle, size, is_lamp=at in lamps)
            continue
        mesh = compiled.triangles(surface, "")
        if mesh is None or len(mesh.indices) > _MOST:
            continue
        points = frame.seen(mesh.vertices @ placement[:, :3].T + placement[:, 3] + shift)
        if at in lamps:
            found.lamps.update(_flat(_edges(points, mesh.indices)))
            continue
        edges = _edges(points, mesh.indices)
        found.below.update(_flat(_under(edges)))
        found.cut.update(_flat(_cut(points[mesh.indices])))
    return found


def _placed(compiled: Compiled) -> Iterator[tuple[int, scene_pb2.Surface, Values]]:
    """All surfaces, as often as they are in the scene, with the matrix that places them."""
    frames: dict[int, list[Values]] = {0: [np.eye(3, 4)]}
    for instance in compiled.message.instances:
        matrix = np.array(instance.transforms[:12]).reshape(3, 4)
        frames.setdefault(instance.group, []).append(matrix)
    for at, surface in enumerate(compiled.message.surfaces):
        for matrix in frames.get(surface.group, ()):
            yield at, surface, matrix


def _edges(points: Values, indices: NDArray[np.int64]) -> Values:
    """Ends of the edges at which a surface ends or bends, shape (n, 2, 3)."""
    _, same = np.unique(np.round(points / _SAME).astype(np.int64), axis=0, return_inverse=True)
    corners = same.reshape(-1)[indices]
    normals = area_vectors(points[indices])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(lengths > 0, lengths, 1.0)
    pairs = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    ends = np.concatenate([indices[:, [0, 1]], indices[:, [1, 2]], indices[:, [2, 0]]])
    faces = np.tile(np.arange(len(indices)), 3)
    pairs = np.sort(pairs, axis=1)
    _, first, edge, count = np.unique(
        pairs, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    edge = edge.reshape(-1)
    sums = np.zeros((len(first), 3))
    np.add.at(sums, edge, normals[faces])
    # Two even faces' normals have a sum as long as both; folded ones' a shorter one.
    even = (count == 2) & ((sums**2).sum(axis=1) > 2.0 + 2.0 * _FLAT)
    found: Values = points[ends[first[~even]]]
    return found


def _under(edges: Values) -> Values:
    """The parts of edges that are not above the plane."""
    heights = edges[..., 2]
    kept = heights.min(axis=1) <= _SAME
    edges, heights = edges[kept].copy(), heights[kept]
    for end, other in ((0, 1), (1, 0)):
        above = heights[:, end] > _SAME
        part = heights[above, end] / (heights[above, end] - heights[above, other])
        edges[above, end] += part[:, None] * (edges[above, other] - edges[above, end])
    return edges


def _cut(corners: Values) -> Values:
    """Where triangles, shape (n, 3, 3), meet the plane."""
    heights = corners[..., 2]
    crossing = (heights.min(axis=1) < -_SAME) & (heights.max(axis=1) > _SAME)
    found = []
    for triangle in corners[crossing]:
        ends = []
        for one, other in ((0, 1), (1, 2), (2, 0)):
            a, b = triangle[one], triangle[other]
            if (a[2] > 0.0) != (b[2] > 0.0):
                ends.append(a + a[2] / (a[2] - b[2]) * (b - a))
        if len(ends) == 2:
            found.append(ends)
    return np.array(found).reshape(-1, 2, 3)


def _add_round(found: PlanLines, middle: Values, radius: float, *, is_lamp: bool) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, _ROUND + 1)
    height = float(middle[2])
    if not is_lamp and height > radius:
        return
    is_cut = abs(height) < radius
    size = np.sqrt(radius**2 - height**2) if is_cut and not is_lamp else radius
    ring = middle[:2] + size * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    segments = set(_flat(np.stack([ring[:-1], ring[1:]], axis=1)))
    (found.lamps if is_lamp else found.cut if is_cut else found.below).update(segments)


def _flat(edges: Values) -> Iterator[Segment]:
    """Each once, and none that is seen end on."""
    rounded = np.round(edges[:, :, :2], 4)
    for (a, b), (c, d) in rounded.tolist():
        if abs(a - c) + abs(b - d) > 10.0 * _SAME:
            yield (a, b, c, d) if (a, b) < (c, d) else (c, d, a, b)


def clipped(segments: Iterable[Segment], box: tuple[float, float, float, float]) -> Iterator[Segment]:
    """Their parts inside of a box (left, bottom, right, top): Y.-D. Liang and B. Barsky 1984."""
    left, bottom, right, top = box
    for x0, y0, x1, y1 in segments:
        dx, dy = x1 - x0, y1 - y0
        first, last = 0.0, 1.0
        for step, room in ((-dx, x0 - left), (dx, right - x0), (-dy, y0 - bottom), (dy, top - y0)):
            if step == 0.0:
                if room < 0.0:
                    first, last = 1.0, 0.0
            elif step < 0.0:
                first = max(first, room / step)
            else:
                last = min(last, room / step)
        if first < last:
            yield x0 + first * dx, y0 + first * dy, x0 + last * dx, y0 + last * dy
