"""The tabular method of unified glare rating: a luminaire in standard rooms (CIE 117:1995, CIE 190:2010).

A room is X wide and Y long, in heights H of the luminaires above the eye, and reaches from the eye's plane
up to theirs. Luminaires fill the ceiling in even rows. The eye is in the middle of a wall of width X and
looks along Y, crosswise or endwise to the luminaires' length. Light that comes back from surfaces is that of
three even and diffuse ones, ceiling, walls and the eye's plane, which gives the factors that CIE 190 lists.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nocturne_scene.photometry.glare import TABLE_ENDS, position_index
from nocturne_scene.photometry.intensities import Photometry
from nocturne_scene.spectra.published import Floats

View = Literal["crosswise", "endwise"]

ROOMS = (
    *((2, y) for y in (2, 3, 4, 6, 8, 12)),
    *((4, y) for y in (2, 3, 4, 6, 8, 12)),
    *((8, y) for y in (4, 6, 8, 12)),
    *((12, y) for y in (4, 6, 8)),
)
"""X and Y, in H."""

REFLECTANCES = ((0.7, 0.5, 0.2), (0.7, 0.3, 0.2), (0.5, 0.5, 0.2), (0.5, 0.3, 0.2), (0.3, 0.3, 0.2))
"""Of ceiling, walls and the eye's plane."""

STANDARD_SPACING = 0.25
"""Between the middles of luminaires, in H."""

_DIRECTIONS = (90, 72)
"""Of a luminaire's flux, down and around."""


@dataclass(frozen=True)
class Room:
    """Edges and spacing in H, and H in metres, on which a rating depends by the luminaire's size."""

    x: float
    y: float
    height: float = 2.0
    """H, m."""
    spacing: float = STANDARD_SPACING

    def places(self) -> Floats:
        """To the side and ahead of the eye, m."""
        across = (np.arange(round(self.x / self.spacing)) + 0.5) * self.spacing - 0.5 * self.x
        ahead = (np.arange(round(self.y / self.spacing)) + 0.5) * self.spacing
        return self.height * np.stack(np.meshgrid(across, ahead), axis=-1).reshape(-1, 2)

    @property
    def wall_area(self) -> float:
        """m2, of all four."""
        return 2.0 * (self.x + self.y) * self.height**2


@dataclass(frozen=True)
class Shares:
    """Of the flux of all luminaires, lm: what falls straight on each surface."""

    ceiling: float
    walls: float
    floor: float


def table(
    photometry: Photometry, spacing: float = STANDARD_SPACING
) -> Iterator[tuple[Room, View, list[float]]]:
    """Ratings for all REFLECTANCES, by room and direction of view. Raises ValueError as `rating`."""
    for x, y in ROOMS:
        room = Room(x, y, spacing=spacing)
        for view in ("crosswise", "endwise"):
            shares = shares_of(photometry, room, view)
            yield room, view, [rating(photometry, room, view, shares, each) for each in REFLECTANCES]


def rating(
    photometry: Photometry, room: Room, view: View, shares: Shares, reflectances: tuple[float, float, float]
) -> float:
    """Of one room. Raises ValueError for a luminaire without a flat opening below."""
    area = abs(photometry.opening[0]) * abs(photometry.opening[1])
    if photometry.opening[0] < 0.0:
        area *= 0.25 * math.pi
    if not area > 0.0:
        raise ValueError("the file tells no luminous opening, so that luminance is not known")
    beside, ahead = room.places().T
    distance2 = beside**2 + ahead**2 + room.height**2
    candela = _towards_eye(photometry, view, beside, ahead, room.height)
    projected = area * room.height / np.sqrt(distance2)
    index = position_index(beside, np.full(len(beside), room.height), ahead)
    # Beyond the table of CIE 117 luminaires are left out.
    counts = (np.abs(beside) <= TABLE_ENDS[0] * ahead) & (room.height <= TABLE_ENDS[1] * ahead)
    sources = float((candela**2 / (projected * distance2 * index**2))[counts].sum())
    behind = background(room, shares, reflectances)
    return 8.0 * math.log10(0.25 / behind * sources) if sources > 0.0 and behind > 0.0 else math.nan


def background(room: Room, shares: Shares, reflectances: tuple[float, float, float]) -> float:
    """L_b, cd/m2: the walls' indirect illuminance over pi."""
    back = returns_to_walls(room, reflectances)
    flux = shares.ceiling * back[0] + shares.walls * back[1] + shares.floor * back[2]
    return float(flux) / room.wall_area / math.pi


def returns_to_walls(room: Room, reflectances: tuple[float, float, float]) -> Floats:
    """Of flux that falls first on ceiling, walls or floor, what reaches the walls after reflections."""
    areas = np.array([room.x * room.y, room.wall_area / room.height**2, room.x * room.y])
    across = _parallel(room.x, room.y)
    to_walls = 1.0 - across
    from_walls = to_walls * areas[0] / areas[1]
    factors = np.array(
        [
            [0.0, to_walls, across],
            [from_walls, 1.0 - 2.0 * from_walls, from_walls],
            [across, to_walls, 0.0],
        ]
    )
    first = np.diag(1.0 / areas)
    whole = np.linalg.solve(np.eye(3) - factors * np.array(reflectances), first)
    return np.asarray((whole - first)[1] * areas[1], dtype=np.float64)


def shares_of(photometry: Photometry, room: Room, view: View) -> Shares:
    """Of light that goes up all falls on the ceiling; of light that goes down on floor and walls."""
    rows, columns = _DIRECTIONS
    cosine = 1.0 - 2.0 * (np.arange(2 * rows) + 0.5) / (2 * rows)
    azimuth = (np.arange(columns) + 0.5) * 2.0 * math.pi / columns
    gamma = np.degrees(np.arccos(cosine))
    candela = _intensity(photometry, np.degrees(azimuth)[None, :], gamma[:, None])
    flux = candela * (4.0 * math.pi / candela.size)
    places = room.places()
    up = float(flux[rows:].sum()) * len(places)
    down = flux[:rows]
    # Where light meets the eye's plane: x to the side, y ahead. A luminaire's length is along y endwise.
    reach = room.height * np.tan(np.radians(gamma[:rows]))[:, None]
    turn = 0.5 * math.pi if view == "crosswise" else 0.0
    ahead, beside = reach * np.cos(azimuth + turn), reach * np.sin(azimuth + turn)
    half, length = 0.5 * room.x * room.height, room.y * room.height
    floor = 0.0
    for x, y in places:
        meets = (np.abs(beside + x) <= half) & (ahead + y >= 0.0) & (ahead + y <= length)
        floor += float(down[meets].sum())
    return Shares(up, float(down.sum()) * len(places) - floor, floor)


def _towards_eye(photometry: Photometry, view: View, beside: Floats, ahead: Floats, height: float) -> Floats:
    gamma = np.degrees(np.arctan2(np.hypot(beside, ahead), height))
    # From the length of the luminaire, which is along the line of sight or across it.
    plane = np.degrees(np.arctan2(-beside, -ahead)) - (90.0 if view == "crosswise" else 0.0)
    return _intensity(photometry, plane, gamma)


def _intensity(photometry: Photometry, plane: Floats, gamma: Floats) -> Floats:
    """cd, straight between the file's angles; none beyond them."""
    plane, gamma = np.broadcast_arrays(plane % 360.0, gamma)
    by_plane = np.stack(
        [np.interp(gamma, photometry.vertical, row, left=0.0, right=0.0) for row in photometry.candela]
    )
    if len(photometry.horizontal) == 1:
        return np.asarray(by_plane[0], dtype=np.float64)
    place = np.interp(plane, photometry.horizontal, np.arange(len(photometry.horizontal)))
    low = np.minimum(place.astype(np.int64), len(photometry.horizontal) - 2)
    part = place - low
    first = np.take_along_axis(by_plane, low[None], axis=0)[0]
    second = np.take_along_axis(by_plane, low[None] + 1, axis=0)[0]
    return np.asarray((1.0 - part) * first + part * second, dtype=np.float64)


def _parallel(x: float, y: float) -> float:
    """Between two equal rectangles, a height apart (Howell C-11)."""
    a, b = math.sqrt(1.0 + x * x), math.sqrt(1.0 + y * y)
    whole = (
        math.log(a * b / math.sqrt(1.0 + x * x + y * y))
        + x * b * math.atan(x / b)
        + y * a * math.atan(y / a)
        - x * math.atan(x)
        - y * math.atan(y)
    )
    return 2.0 / (math.pi * x * y) * whole
