"""Shapes of every type within a ball, where they stand and how they move."""

from collections.abc import Callable
from typing import Any

import numpy as np

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.chance import Chance, Point, short, shortened
from tests.crossings.draft import Draft

_CUBE = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
"""Faces, counter-clockwise from outside; bits of a corner's number are x, y, z."""


def placed(draft: Draft, centre: Point, radius: float, *, closed: bool, mapped: bool) -> Document:
    """Fields `shape`, and of its placement, of a surface within a ball.

    `closed`: it bounds a body. `mapped`: it has texture coordinates.
    """
    chance = draft.chance
    if chance.maybe(0.5):
        return {"shape": shape(chance, centre, radius, closed=closed, mapped=mapped)}
    scale = chance.pick([1.0, 1.0, 0.5, 2.0])
    made: Document = {
        "shape": shape(chance, [0.0, 0.0, 0.0], short(radius / scale), closed=closed, mapped=mapped)
    }
    if scale != 1.0:
        made["scale"] = scale
    if chance.maybe(0.7):
        made["rotate"] = rotation(chance, 180.0)
    return made | {"translate": centre}


def shape(chance: Chance, centre: Point, radius: float, *, closed: bool, mapped: bool) -> Document:
    """A shape within a ball."""
    kinds: list[Callable[[Chance, Point, float, bool], Document]] = [_sphere, _box, _solid, _file, _needles]
    if not closed:
        kinds += [_quad, _disc, _sheet]
    return chance.pick(kinds)(chance, centre, radius, mapped)


def standing_box(centre: Point, radius: float, floor: float) -> Document:
    """A box that touches the floor."""
    across = short(0.5 * radius)
    x, _, z = centre
    high = round(floor + 1.2 * radius, 4)
    return {
        "type": "box",
        "minimum": shortened([x - across, floor, z - across]),
        "maximum": shortened([x + across, high, z + across]),
    }


def rotation(chance: Chance, degrees: float) -> Document:
    return {"axis": chance.direction(), "degrees": chance.number(-degrees, degrees)}


def motion(draft: Draft, centre: Point, reach: float, *, of: Document | None = None) -> Document:
    """While the shutter is open; a ball around `centre` stays within `reach` of where it is.

    `of`: a surface that may change its size, unless it is a sphere.
    """
    chance = draft.chance
    if chance.maybe(0.3):
        sizes = [1.0, 0.8] if of is not None and of["shape"]["type"] != "sphere" else [1.0]
        return {"placements": [_about(chance, centre, reach, sizes) for _ in range(chance.whole(2, 3))]}
    made: Document = {}
    if chance.maybe(0.5):
        made["rotate"] = rotation(chance, 90.0) | {"about": centre}
    if not made or chance.maybe(0.6):
        made["translate"] = chance.near([0.0, 0.0, 0.0], reach)
    return made


def _about(chance: Chance, centre: Point, reach: float, sizes: list[float]) -> Document:
    """A placement that keeps the centre near itself."""
    scale = chance.pick(sizes)
    turn = rotation(chance, 40.0)
    moved = scale * matrix(turn) @ np.array(centre)
    shift = chance.near([0.0, 0.0, 0.0], reach)
    made: Document = {"rotate": turn, "translate": shortened(np.array(centre) - moved + shift)}
    return made | ({"scale": scale} if scale != 1.0 else {})


def matrix(turn: Document) -> Any:
    """Of a rotation, by Rodrigues' formula; the axis need not have length 1."""
    x, y, z = np.array(turn["axis"]) / np.linalg.norm(turn["axis"])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(turn["degrees"])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def _sphere(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    return {"type": "sphere", "centre": centre, "radius": short(radius * chance.number(0.6, 1.0))}


def _box(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    half = np.array([chance.number(0.25, 0.57) for _ in range(3)]) * radius
    low, high = shortened(np.array(centre) - half), shortened(np.array(centre) + half)
    return {"type": "box", "minimum": low, "maximum": high}


def _solid(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    """A closed mesh: a cube whose corners are moved."""
    corners = np.array([[bit >> axis & 1 for axis in range(3)] for bit in range(8)]) - 0.5
    corners = corners * 0.9 * radius + np.array([chance.near([0, 0, 0], 0.1 * radius) for _ in range(8)])
    triangles = [list(part) for a, b, c, d in _CUBE for part in ((a, b, c), (a, c, d))]
    made: Document = {"type": "mesh", "vertices": [shortened(np.array(centre) + each) for each in corners]}
    made["triangles"] = triangles
    if chance.maybe(0.4):
        made["smooth"] = True
        if chance.maybe(0.5):
            made["normals"] = [shortened(each / np.linalg.norm(each)) for each in corners]
    if mapped or chance.maybe(0.2):
        made["texture_coordinates"] = [[chance.number(0, 2), chance.number(0, 2)] for _ in corners]
    return made


def _file(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    """Around the origin, where it is."""
    if centre != [0.0, 0.0, 0.0] or abs(radius - 1.0) > 1e-9:
        return _solid(chance, centre, radius, mapped)
    return file_mesh(chance, mapped=mapped)


def file_mesh(chance: Chance, *, mapped: bool) -> Document:
    """Within a ball of radius 1 around the origin."""
    name = assets.MESHES[0] if mapped else chance.pick(assets.MESHES)
    made: Document = {"type": "mesh", "asset": name}
    if chance.maybe(0.4):
        made["format"] = name.rpartition(".")[2]
    if chance.maybe(0.5):
        made["smooth"] = chance.maybe(0.7)
    return made


def _needles(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    """A closed double cone of long thin triangles."""
    if mapped:
        return _solid(chance, centre, radius, mapped)
    count = chance.whole(40, 150)
    around = np.arange(count) * 2.0 * np.pi / count
    wide = radius * chance.number(0.5, 0.9)
    high = radius * chance.number(0.3, 0.95)
    ring = np.stack([wide * np.cos(around), np.zeros(count), wide * np.sin(around)], axis=-1)
    points = [[0.0, high, 0.0], [0.0, -0.3 * high, 0.0], *ring]
    made: Document = {"type": "mesh", "vertices": [shortened(np.array(centre) + each) for each in points]}
    made["triangles"] = [
        triangle
        for index in range(count)
        for one, other in [(2 + index, 2 + (index + 1) % count)]
        for triangle in ([0, other, one], [1, one, other])
    ]
    return made


def _quad(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    u = np.array(chance.direction())
    v = np.cross(u, chance.direction())
    v *= chance.number(0.5, 1.0) / np.linalg.norm(v)
    u, v = 1.3 * radius * u, 1.3 * radius * (v + 0.2 * u)
    corner = shortened(np.array(centre) - 0.5 * (u + v))
    return {"type": "quad", "corner": corner, "edge_u": shortened(u), "edge_v": shortened(v)}


def _disc(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    made: Document = {"type": "disc", "centre": centre, "normal": chance.direction(), "radius": short(radius)}
    return made | ({"segments": chance.whole(3, 32)} if chance.maybe(0.7) else {})


def _sheet(chance: Chance, centre: Point, radius: float, mapped: bool) -> Document:
    """An open mesh of two triangles that are not in one plane."""
    corners = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]) * 0.6 * radius
    corners[:, 1] = [chance.number(-0.3, 0.3) * radius for _ in range(4)]
    made: Document = {"type": "mesh", "vertices": [shortened(np.array(centre) + each) for each in corners]}
    made["triangles"] = [[0, 1, 2], [0, 2, 3]]
    made["texture_coordinates"] = [[0, 0], [0, 1], [1, 1], [1, 0]]
    return made | ({"smooth": True} if chance.maybe(0.3) else {})
