"""Surfaces of Radiance as triangles. z, which is up there, becomes y, and north becomes -z."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.radiance.read.primitives import Primitive
from nocturne_scene.meshes.triangles import Triangles

Values = NDArray[np.float64]

_AROUND = 128
"""Straight sides of a circle: a circle's area is 4e-4 too small."""
_LEVEL = 1e-6


def turned(points: Values) -> Values:
    """x to the east, y up, z to the south."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


def polygon(given: Primitive) -> Triangles:
    """Its normal is by the right-hand rule. Holes are joined to the outside by seams, as Radiance has it."""
    if len(given.numbers) < 9 or len(given.numbers) % 3:
        found = len(given.numbers)
        raise InputError.at(
            given.place, f"polygon {given.name}: expected three numbers a corner, found {found}"
        )
    corners = np.array(given.numbers).reshape(-1, 3)
    if not np.isfinite(corners).all():
        raise InputError.at(given.place, f"polygon {given.name}: a corner is not finite")
    normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    size = np.linalg.norm(normal)
    if not size > 0.0:
        raise InputError.at(given.place, f"polygon {given.name}: it has no area")
    flat = np.delete(corners, int(np.abs(normal).argmax()), axis=1)
    # Seen from the side that the normal points to.
    axis = int(np.abs(normal).argmax())
    if (normal[axis] < 0.0) != (axis == 1):
        flat = flat[:, ::-1]
    return Triangles(turned(corners), np.array(_ears(flat), dtype=np.int64).reshape(-1, 3))


def _ears(points: Values) -> list[tuple[int, int, int]]:
    """Triangles of a polygon that turns left, by cutting ears (G. Meisters 1975)."""
    left, found = list(range(len(points))), list[tuple[int, int, int]]()

    def twice_area(a: int, b: int, c: int) -> float:
        (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
        return float((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))

    slack = 1e-12 * float(np.ptp(points, axis=0).prod())
    while len(left) > 2:
        for at in range(len(left)):
            a, b, c = left[at - 1], left[at], left[(at + 1) % len(left)]
            size = twice_area(a, b, c)
            if size < -slack:
                continue
            inside = any(
                twice_area(a, b, each) > slack
                and twice_area(b, c, each) > slack
                and twice_area(c, a, each) > slack
                for each in left
                if not any(np.array_equal(points[each], points[corner]) for corner in (a, b, c))
            )
            on_diagonal = size > slack and any(
                abs(twice_area(c, a, each)) <= slack and _between(points[c], points[a], points[each])
                for each in left
                if not any(np.array_equal(points[each], points[corner]) for corner in (a, b, c))
            )
            if not inside and not on_diagonal:
                break
        else:
            at = 0
            a, b, c = left[-1], left[0], left[1]
            size = twice_area(a, b, c)
        if size > slack:
            found.append((a, b, c))
        del left[at]
    return found


def _between(one: Values, other: Values, point: Values) -> bool:
    along = other - one
    return bool(0.0 < (point - one) @ along < along @ along)


def ring(given: Primitive) -> Triangles:
    """Between two circles; one without an inner radius is a disc."""
    x, y, z, nx, ny, nz, first, second = given.need(8)
    inner, outer = sorted((first, second))
    axis = _axis((nx, ny, nz), given)
    if not (outer > 0.0 and inner >= 0.0):
        raise InputError.at(given.place, f"ring {given.name}: expected radii of which one is above 0")
    circle = _circle(axis)
    middle = np.array([x, y, z])
    return _band(middle + outer * circle, middle + inner * circle, smooth=False)


def cone(given: Primitive, *, inwards: bool) -> Triangles:
    """A frustum without ends: two middles and two radii."""
    numbers = given.need(8)
    return _frustum(given, numbers[:3], numbers[3:6], numbers[6], numbers[7], inwards=inwards)


def cylinder(given: Primitive, *, inwards: bool) -> Triangles:
    """Without ends."""
    numbers = given.need(7)
    return _frustum(given, numbers[:3], numbers[3:6], numbers[6], numbers[6], inwards=inwards)


def _frustum(
    given: Primitive,
    start: Sequence[float],
    end: Sequence[float],
    first: float,
    second: float,
    *,
    inwards: bool,
) -> Triangles:
    low, high = np.array(start), np.array(end)
    axis = _axis(tuple(high - low), given)
    if min(first, second) < 0.0 or not max(first, second) > 0.0:
        raise InputError.at(given.place, f"{given.kind} {given.name}: expected a radius above 0")
    circle = _circle(axis)
    mesh = _band(low + first * circle, high + second * circle, smooth=True)
    return Triangles(mesh.vertices, mesh.indices[:, ::-1]) if inwards else mesh


def _circle(axis: Values) -> Values:
    """Points on the unit circle about an axis, the first one again at the end."""
    across = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    across /= np.linalg.norm(across)
    angle = np.linspace(0.0, 2.0 * math.pi, _AROUND + 1)[:, None]
    return np.asarray(np.cos(angle) * across + np.sin(angle) * np.cross(axis, across))


def _band(one: Values, other: Values, *, smooth: bool) -> Triangles:
    """Between two circles; its normal is outwards, or along the axis where both lie in one plane."""
    del smooth
    count = len(one)
    first = np.arange(count - 1)
    lower = np.stack([first, first + 1, first + count], axis=1)
    upper = np.stack([first + 1, first + count + 1, first + count], axis=1)
    points = np.concatenate([one, other])
    indices = np.concatenate([lower, upper])
    a, b, c = (points[indices[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return Triangles(turned(points), indices[area > 0.0])


def _axis(vector: Sequence[float], given: Primitive) -> Values:
    found = np.array(vector)
    length = np.linalg.norm(found)
    if not np.isfinite(length) or not length > 0.0:
        raise InputError.at(given.place, f"{given.kind} {given.name}: its axis has no length")
    return np.asarray(found / length)


MESHES: dict[str, Callable[[Primitive], Triangles]] = {
    "polygon": polygon,
    "ring": ring,
    "cylinder": lambda given: cylinder(given, inwards=False),
    "tube": lambda given: cylinder(given, inwards=True),
    "cone": lambda given: cone(given, inwards=False),
    "cup": lambda given: cone(given, inwards=True),
}
"""By kinds, all but spheres."""
