"""Triangles that nobody would draw on purpose."""

from math import cos, pi, sin
from typing import Any

import numpy as np

from tests.accuracy.tracing import Document
from tests.stability.build import FURNACE_SOURCE, beam, diffuse, film, furnace, lit, surface, walls
from tests.stability.case import Case


def _cube(extra: list[list[int]], doubled: bool = False) -> Document:
    """The furnace's walls as one mesh, normals inwards, with further triangles."""
    vertices = [[float(i & 1), float(i >> 1 & 1), float(i >> 2 & 1)] for i in range(8)]
    quads = [(0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5)]
    triangles = [list(t) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    triangles = triangles * (2 if doubled else 1) + extra
    mesh = {"type": "mesh", "vertices": vertices, "triangles": triangles}
    document = furnace(0.5)
    document["surfaces"] = [surface(mesh, diffuse(0.5), 1.0)]
    return document


def _zero_area() -> Case:
    return Case(
        "triangles without an area",
        "a mesh with 20 % of triangles that are a line or a point",
        _cube([[0, 0, 1], [2, 2, 2], [4, 5, 4]]),
        2.0 * pi,
        FURNACE_SOURCE,
    )


def _doubled() -> Case:
    return Case(
        "every triangle twice",
        "opaque lamps in the same place: light must not be counted twice",
        _cube([], doubled=True),
        2.0 * pi,
        FURNACE_SOURCE + "; doubled triangles are one",
        remedy="remove doubled triangles, or one-sided luminaires in the same place",
    )


def _back_to_back() -> Case:
    """Each wall has a second one in the same place that faces in the opposite direction."""
    document = furnace(0.5)
    for wall in list(document["surfaces"]):
        shape = wall["shape"]
        turned = shape | {"edge_u": shape["edge_v"], "edge_v": shape["edge_u"]}
        document["surfaces"].append({**wall, "shape": turned})
    return Case(
        "walls back to back",
        "two squares in the same place that face in opposite directions, each a one-sided lamp",
        document,
        2.0 * pi,
        FURNACE_SOURCE,
        remedy="leave a gap between them, or use one luminaire with two_sided",
    )


def _winding() -> Case:
    """A wall of albedo 0.5 whose triangles have random orientations."""
    steps = 5
    at = np.linspace(-1.0, 1.0, steps)
    vertices = [[x, y, 0.0] for y in at.tolist() for x in at.tolist()]
    triangles = []
    for i in range(steps - 1):
        for j in range(steps - 1):
            a, b, c, d = i * steps + j, i * steps + j + 1, (i + 1) * steps + j + 1, (i + 1) * steps + j
            triangles += [[a, b, c], [a, d, c]]
    mesh = {"type": "mesh", "vertices": vertices, "triangles": triangles}
    return Case(
        "triangles wound at random",
        "normals of an open mesh point to both sides",
        lit(beam(45.0, 0.5), [surface(mesh, diffuse(0.5))]),
        0.5,
        "a diffuse wall is diffuse on both sides",
    )


def _inside_out() -> Case:
    """A ball of glass as a mesh with its normals inwards."""
    mesh = _ball(16, 32)
    mesh["triangles"] = [[a, c, b] for a, b, c in mesh["triangles"]]
    glass = {"type": "dielectric", "index": 1.5}
    return Case(
        "glass inside out",
        "a closed mesh of glass whose normals point inwards",
        lit(beam(0.0, 0.5, 5.0), [surface(mesh, glass)]),
        1.0,
        "clear glass in even light can't be seen",
        remedy="turn the triangles round",
    )


def _smooth() -> Case:
    """Interpolated normals on a coarse ball."""
    mesh = _ball(6, 8) | {"smooth": True}
    return Case(
        "smooth normals on a coarse ball",
        "a ball of 80 triangles with interpolated normals, albedo 1",
        lit(beam(0.0, 1.9, 5.0), [surface(mesh, diffuse(1.0))], sky=1.0),
        1.0,
        "a white convex body in even light can't be seen; interpolated normals are an approximation",
        remedy="a finer mesh, or flat triangles",
        samples=64,
    )


def _ball(rings: int, segments: int) -> Document:
    """Of radius 1, closed, normals outwards."""
    vertices: list[list[float]] = [[0.0, 0.0, -1.0]]
    for ring in range(1, rings):
        tilt = pi * ring / rings
        for segment in range(segments):
            turn = 2.0 * pi * segment / segments
            vertices.append([sin(tilt) * cos(turn), sin(tilt) * sin(turn), -cos(tilt)])
    top = len(vertices)
    vertices.append([0.0, 0.0, 1.0])
    after = [(i + 1) % segments for i in range(segments)]
    triangles = [[0, 1 + after[i], 1 + i] for i in range(segments)]
    for ring in range(rings - 2):
        a, b = 1 + ring * segments, 1 + (ring + 1) * segments
        for i in range(segments):
            triangles += [[a + i, a + after[i], b + after[i]], [a + i, b + after[i], b + i]]
    last = top - segments
    triangles += [[last + i, last + after[i], top] for i in range(segments)]
    return {"type": "mesh", "vertices": vertices, "triangles": triangles}


def _nested() -> Case:
    """Instances of instances of instances of instances; the scales' product is 1."""
    scales = (1e-6, 1e6, 1e-3, 1e3)
    groups: dict[str, Any] = {"0": walls([-0.5, -0.5, -0.5], 1.0, diffuse(0.5), 1.0)}
    for level, scale in enumerate(scales[:-1]):
        groups[str(level + 1)] = [{"group": str(level), "scale": scale}]
    document = lit(film([0, 0, 0], [0, 0, 1], 0.5), [], sky=None)
    document |= {"groups": groups, "instances": [{"group": "3", "scale": scales[-1]}]}
    return Case(
        "nested instances, scales 1e-6 to 1e6",
        "four levels of instances whose scales cancel",
        document,
        2.0 * pi,
        FURNACE_SOURCE,
    )


CASES = [_zero_area(), _doubled(), _back_to_back(), _winding(), _inside_out(), _smooth(), _nested()]
