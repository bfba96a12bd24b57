"""CIE 171:2006, "Test cases to assess the accuracy of lighting computer programs": its analytic cases.

Tables of the report that are wrong are replaced by the formulas that they stand for, as notes in
`cie171.json` say. Rooms are of 4 m x 4 m x 3 m, z up.
"""

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.closed_forms import (
    parallel_rectangles,
    perpendicular_rectangles,
    plate,
)
from nocturne_scene.validation.documents import (
    Document,
    Point,
    along,
    box,
    diffuse,
    disc,
    film,
    quad,
    screen,
    sphere,
    surface,
)
from nocturne_scene.validation.skies import SUN, TYPES, Values, horizontal_illuminance, through_opening
from nocturne_scene.validation.truths import truths

WALL_A_TO_F: list[Point] = [([2.0, 0.0, z], [0.0, 1.0, 0.0]) for z in (2.75, 2.25, 1.75, 1.25, 0.75, 0.25)]
FLOOR_G_TO_N: list[Point] = [([2.0, 0.25 + 0.5 * i, 0.0], [0.0, 0.0, 1.0]) for i in range(8)]
CEILING_G_TO_N: list[Point] = [([2.0, 0.25 + 0.5 * i, 3.0], [0.0, 0.0, -1.0]) for i in range(8)]
_NAMES = "ABCDEFGHIJKLMN"

ROOM = [
    surface(quad([0, 0, 0], [4, 0, 0], [0, 4, 0])),
    surface(quad([0, 0, 0], [0, 0, 3], [4, 0, 0])),
    surface(quad([0, 4, 0], [4, 0, 0], [0, 0, 3])),
    surface(quad([0, 0, 0], [0, 4, 0], [0, 0, 3])),
    surface(quad([4, 0, 0], [0, 0, 3], [0, 4, 0])),
]
"""Black: floor, and the walls y = 0, y = 4, x = 0, x = 4."""

_REPORT = "CIE 171:2006, {}: {}"


def _white(luminance: float) -> Document:
    """An even spectrum."""
    return {"constant": 1.0, "luminance": luminance}


def _lamp(shape: Document, luminance: float) -> Document:
    return {
        "shape": shape,
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": _white(luminance)},
    }


def _at(point: Point) -> Document:
    """A small film in front of a wall, which it does not touch."""
    place, normal = point
    centre = (np.array(place) + 2e-6 * np.array(normal)).tolist()
    return film(centre, normal, 1e-4)


def _points(
    case: str,
    name: str,
    surfaces: list[Document],
    points: list[Point],
    known: list[float],
    factor: float = 1.0,
    names: str = "",
    samples: int = 2**16,
    **more: Any,
) -> Iterator[Scene]:
    for index, (point, truth) in enumerate(zip(points, known, strict=True)):
        if truth > 0.0:
            document = {"nocturne": 1, "sensor": _at(point), "surfaces": surfaces, **more}
            label = names[index] if names else f"x {point[0][0]:g}, y {point[0][1]:g}"
            value = Value(f"{case}, {label}", truth, _REPORT.format(case, name), "Y", factor)
            yield Scene(document, (value,), samples)


def scenes() -> Iterator[Scene]:
    """All cases."""
    table = truths("cie171")
    radius = 0.005
    lamp = _lamp(disc([0, 0, 3], [0, 0, -1], radius), 1000.0 / (pi * radius**2))
    floor: list[Point] = [([x, y, 0.0], [0.0, 0.0, 1.0]) for x, y in table["5.2"]["xy"]]
    yield from _points("5.2", "point source, E = I h^2 / d^4", [lamp], floor, table["5.2"]["lx"])
    lamp = _lamp(quad([1.5, 1.5, 3], [0, 1, 0], [1, 0, 0]), 1000.0)
    known = table["5.3"]["A to N"]
    wall_and_floor = WALL_A_TO_F + FLOOR_G_TO_N
    yield from _points(
        "5.3", "area source by Lambert's formula", [*ROOM, lamp], wall_and_floor, known, 1.0, _NAMES
    )
    yield from _flux_through_a_roof()
    yield from _glass()
    lamp = _lamp(quad([0, 0, 0], [4, 0, 0], [0, 4, 0]), 100.0 / pi)
    points = WALL_A_TO_F[4:0:-1] + WALL_A_TO_F[:1] + CEILING_G_TO_N
    name = "diffuse floor, by Lambert's formula"
    letters = "BCDEFGHIJKLMN"
    yield from _points("5.6", name, [*ROOM[1:], lamp], points, table["5.6"]["B to N"], 1.0, letters)
    lamp = _lamp(quad([0, 4, 0], [4, 0, 0], [0, 0, 3]), 100.0 / pi)
    surfaces = [ROOM[0], ROOM[1], ROOM[3], ROOM[4], lamp, surface(box([0, 2.5, 0], [4, 2.7, 1]))]
    name = "diffuse wall behind an obstruction; its table 19 as corrected by I. Ashdown (2016)"
    yield from _points(
        "5.7", name, surfaces, WALL_A_TO_F + FLOOR_G_TO_N[:5], table["5.7"]["A to K"], 1.0, _NAMES
    )
    yield from _cube(table["5.8"]["lx"])
    yield from _roof_openings(table["5.9"]["A to N"])
    yield from _daylight()


def _flux_through_a_roof() -> Iterator[Scene]:
    """The whole ceiling is open to an even sky: floor and walls together get all incoming light."""
    source = _REPORT.format("5.4", "flux through an opening; its parts by C-11 and C-14")
    side = perpendicular_rectangles(4.0, 3.0, 4.0)
    meters = {
        "floor": (film([2, 2, 1e-5], [0, 0, 1], 4.0), 16.0, parallel_rectangles(4.0, 4.0, 3.0)),
        "wall y = 0": (film([2, 1e-5, 1.5], [0, 1, 0], 3.0, up=[0, 0, 1]), 12.0, side),
        "wall x = 4": (film([4 - 1e-5, 2, 1.5], [-1, 0, 0], 3.0, up=[0, 0, 1]), 12.0, side),
    }
    for name, (meter, area, part) in meters.items():
        document = {
            "nocturne": 1,
            "sensor": meter,
            "surfaces": ROOM,
            "environment": {"radiance": _white(1000.0 / pi)},
        }
        value = Value(f"5.4, lm to the {name}", 16.0 * 1000.0 * part, source, "Y", area)
        pixels = (1, 1) if name == "floor" else (4, 3)
        yield Scene(document, (value,), 2**17 // (pixels[0] * pixels[1]), pixels)


def _glass() -> Iterator[Scene]:
    """Relative to light along the normal; the report's pane absorbs as well, of which it tells no index."""
    source = _REPORT.format("5.5", "directional transmittance of clear glass, n = 1.52, by Fresnel")
    for degrees in (0, 10, 20, 30, 40, 50, 60, 70, 80):
        pane = {
            "shape": quad([-9, -9, 0], [18, 0, 0], [0, 18, 0]),
            "kernel": {"type": "thin_pane", "index": 1.52},
        }
        document = {
            "nocturne": 1,
            "sensor": along(degrees, 1.0),
            "surfaces": [pane, screen(3.0, 1e6, 0.0)],
            "environment": {"radiance": _white(100.0)},
        }
        value = Value(f"5.5, {degrees} deg, %", 100.0 * plate(1.52, degrees)[0], source, "Y")
        yield Scene(document, (value,))


CUBE_CAMERA: Document = {
    "type": "orthographic",
    "position": [2, 2, 0.5],
    "look_at": [2, 2, 0],
    "height": 4.0,
}
"""Sees one whole wall of the cube of case 5.8."""


def cube_walls(reflectance: float) -> list[Document]:
    """The six walls of the cube of case 5.8, 4 m wide."""
    corners: list[tuple[list[float], list[float], list[float]]] = [
        ([0, 0, 0], [4, 0, 0], [0, 4, 0]),
        ([0, 0, 4], [4, 0, 0], [0, 4, 0]),
        ([0, 0, 0], [4, 0, 0], [0, 0, 4]),
        ([0, 4, 0], [4, 0, 0], [0, 0, 4]),
        ([0, 0, 0], [0, 4, 0], [0, 0, 4]),
        ([4, 0, 0], [0, 4, 0], [0, 0, 4]),
    ]
    return [surface(quad(*corner), diffuse(reflectance)) for corner in corners]


def _cube(known: dict[str, float]) -> Iterator[Scene]:
    source = _REPORT.format("5.8", "diffuse reflection in a cube, E = F rho / (S (1 - rho))")
    lamp = {
        "shape": sphere([2, 2, 2], 0.05),
        "kernel": {"type": "null"},
        "luminaire": {"radiance": 1.0, "lumens": 10_000.0},
    }
    for reflectance, lux in known.items():
        document = {
            "nocturne": 1,
            "sensor": CUBE_CAMERA,
            "surfaces": [*cube_walls(float(reflectance)), lamp],
        }
        value = Value(
            f"5.8, reflectance {reflectance}, indirect lx",
            lux,
            source,
            "Y",
            pi / float(reflectance),
            -10_000.0 / 96.0,
        )
        yield Scene(document, (value,))


def _roof_openings(known: dict[str, dict[str, list[float]]]) -> Iterator[Scene]:
    """Daylight factors without glass, of some points of each table."""
    for edge, by_sky in known.items():
        size = float(edge)
        low = 2.0 - size / 2
        corner, edges = [low, low, 3.0], ([size, 0.0, 0.0], [0.0, size, 0.0])
        for kind, column in by_sky.items():
            points, names = (WALL_A_TO_F + FLOOR_G_TO_N)[1::3], _NAMES[1::3]
            name = f"roof opening of {edge} m, sky {kind}"
            yield from _sky_points(
                f"5.9, {edge} m, sky {kind}",
                name,
                int(kind),
                [*ROOM, *ceiling_around(size)],
                points,
                [column[i] for i in range(1, 14, 3)],
                names,
                (corner, edges),
            )


def _sky_points(
    case: str,
    name: str,
    kind: int,
    surfaces: list[Document],
    points: list[Point],
    percent: list[float],
    names: str,
    opening: tuple[list[float], tuple[list[float], list[float]]],
) -> Iterator[Scene]:
    environment: Document = {"cie": kind, "zenith_luminance": 1000.0, "up": [0, 0, 1]}
    if kind in TYPES and TYPES[kind][2]:
        environment["sun"] = list(SUN)
    corner, edges = opening
    factor = 100.0 / (1000.0 * horizontal_illuminance(kind))
    aim = [{"shape": quad(corner, *edges)}]
    yield from _points(
        case,
        name,
        surfaces,
        points,
        percent,
        factor,
        names,
        environment=environment,
        important_directions=aim,
    )


def ceiling_around(opening: float) -> list[Document]:
    """Around an opening in the middle."""
    low, high = 2.0 - opening / 2, 2.0 + opening / 2
    if low <= 0.0:
        return []
    return [
        surface(quad([0, 0, 3], [4, 0, 0], [0, low, 0])),
        surface(quad([0, high, 3], [4, 0, 0], [0, low, 0])),
        surface(quad([0, low, 3], [low, 0, 0], [0, opening, 0])),
        surface(quad([high, low, 3], [low, 0, 0], [0, opening, 0])),
    ]


def _daylight() -> Iterator[Scene]:
    """Cases 5.10 to 5.12: glass in the roof, and an opening in a wall, open and with glass. Of 5.11 and 5.12
    the sky's part: the ground and the obstructions before the wall are dark here."""

    cosines = np.linspace(0.0, 1.0, 2001)
    degrees = np.degrees(np.arccos(cosines))
    passed = np.array([plate(1.52, each)[0] for each in degrees])

    def glass(cosine: Values) -> Values:
        return np.asarray(np.interp(cosine, cosines, passed), dtype=np.float64)

    roof = [1.5, 1.5, 3.0], ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    wall = [1.0, 4.0, 1.0], ([2.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    around = [
        surface(quad([0, 4, 0], [4, 0, 0], [0, 0, 1])),
        surface(quad([0, 4, 2], [4, 0, 0], [0, 0, 1])),
        surface(quad([0, 4, 1], [1, 0, 0], [0, 0, 1])),
        surface(quad([3, 4, 1], [1, 0, 0], [0, 0, 1])),
    ]
    lid = surface(quad([0, 0, 3], [4, 0, 0], [0, 4, 0]))
    dark = surface(quad([-1e4, 4.5, -0.01], [2e4, 0, 0], [0, 2e4, 0]))
    side = [ROOM[0], ROOM[1], ROOM[3], ROOM[4], *around, lid, dark]
    above = [*ROOM, *ceiling_around(1.0)]
    points = [*WALL_A_TO_F[1::2], *FLOOR_G_TO_N[::3]]
    names = "BDFGJM"
    for case, surfaces, opening, glazed in (
        ("5.10, roof glazed", above, roof, True),
        ("5.11, wall open", side, wall, False),
        ("5.12, wall glazed", side, wall, True),
    ):
        corner, edges = opening
        kernel = {"type": "thin_pane", "index": 1.52}
        pane = [{"shape": quad(corner, *edges), "kernel": kernel}] if glazed else []
        for kind in (1, 12, 16):
            outside = horizontal_illuminance(kind)
            percent = [
                100.0 * through_opening(kind, *point, corner, edges, glass if glazed else None) / outside
                for point in points
            ]
            yield from _sky_points(
                f"{case}, sky {kind}",
                "the sky's part by quadrature",
                kind,
                [*surfaces, *pane],
                points,
                percent,
                names,
                opening,
            )
