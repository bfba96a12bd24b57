"""Lines along which an image has one value: marching squares on means over blocks of pixels.

Lorensen and Cline, "Marching cubes" (SIGGRAPH 1987), in two dimensions: an edge between two neighbours is
crossed where linear interpolation says; a saddle is resolved by the mean of its four corners.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.tile_sums import Values

Line = list[tuple[float, float]]

MAX_LEVELS = 32
MAX_POINTS = 50_000
"""Of all lines of a level: more are noise, and nothing that can be looked at."""

MAX_EDGE = 256
"""Blocks along the longer side of the film."""

NOISE = 0.03
"""Relative standard error that half of the blocks may have: blocks are made larger until they have less."""

_MIN_EDGE = 32

# For each of 16 cases, bit 0 being the upper left corner above the level and then clockwise: between which of
# the cell's edges (0 top, 1 right, 2 bottom, 3 left) lines run. Cases 5 and 10 are saddles: as their middle
# is above.
_TOP, _RIGHT, _BOTTOM, _LEFT = range(4)
_RUNS: dict[int, tuple[tuple[int, int], ...]] = {
    **dict.fromkeys((1, 14), ((_LEFT, _TOP),)),
    **dict.fromkeys((2, 13), ((_TOP, _RIGHT),)),
    **dict.fromkeys((4, 11), ((_RIGHT, _BOTTOM),)),
    **dict.fromkeys((8, 7), ((_BOTTOM, _LEFT),)),
    **dict.fromkeys((3, 12), ((_LEFT, _RIGHT),)),
    **dict.fromkeys((6, 9), ((_TOP, _BOTTOM),)),
    5: ((_TOP, _RIGHT), (_BOTTOM, _LEFT)),
    10: ((_LEFT, _TOP), (_RIGHT, _BOTTOM)),
}


class BlockMeans:
    """Means over square blocks of an image that comes some rows after the other; NaN where nothing came."""

    def __init__(self, width: int, height: int, max_edge: int = MAX_EDGE) -> None:
        self.edge = max(1, -(-max(width, height) // max_edge))
        shape = -(-height // self.edge), -(-width // self.edge)
        self._sums, self._variances, self._counts = np.zeros(shape), np.zeros(shape), np.zeros(shape)

    def add(self, values: Values, variance: Values, known: NDArray[np.bool_], left: int, top: int) -> None:
        """`values`: of a part of the film whose upper left pixel is at (left, top), and their variances;
        `known`: which of them count."""
        height, width = values.shape
        rows, row_starts = self._cuts(top, height)
        columns, column_starts = self._cuts(left, width)
        parts = np.where(known, values, 0.0), np.where(known, variance, 0.0), known.astype(np.float64)
        for total, part in zip((self._sums, self._variances, self._counts), parts, strict=True):
            reduced = np.add.reduceat(np.add.reduceat(part, row_starts, axis=0), column_starts, axis=1)
            total[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] += reduced

    def _cuts(self, first: int, length: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        blocks = np.arange(first // self.edge, (first + length - 1) // self.edge + 1)
        return blocks, np.maximum(blocks * self.edge - first, 0)

    def means(self) -> Values:
        """Shape (blocks down, blocks across)."""
        unknown = np.full_like(self._sums, np.nan)
        return np.divide(self._sums, self._counts, out=unknown, where=self._counts > 0)

    def calm(self) -> None:
        """Makes blocks larger, twice at a time, while half of them have more than NOISE, as of pixels that
        know nothing of each other, and there are enough of them for lines."""
        while max(self._sums.shape) > 2 * _MIN_EDGE and self._noise() > NOISE:
            self.edge *= 2
            self._sums, self._variances, self._counts = map(
                _in_twos, (self._sums, self._variances, self._counts)
            )

    def _noise(self) -> float:
        lit = self._sums > 0.0
        return float(np.median(np.sqrt(self._variances[lit]) / self._sums[lit])) if lit.any() else 0.0

    def isolines(self, level: float) -> list[Line]:
        """In pixels of the film, from its upper left corner. Raises InputError where there are too many."""
        return [[(x * self.edge, y * self.edge) for x, y in line] for line in isolines(self.means(), level)]


def _in_twos(blocks: Values) -> Values:
    """Sums over 2 x 2 of them, or fewer at the borders."""
    padded = np.pad(blocks, [(0, edge % 2) for edge in blocks.shape])
    total: Values = padded[::2, ::2] + padded[1::2, ::2] + padded[::2, 1::2] + padded[1::2, 1::2]
    return total


def isolines(values: Values, level: float) -> list[Line]:
    """Lines along which values are `level`, each closed or from border to border, as (x, y) with 0.5 at the
    middle of the first value. Raises InputError where there are more points than MAX_POINTS."""
    links: dict[int, list[int]] = {}
    for one, other in _segments(values, level):
        links.setdefault(one, []).append(other)
        links.setdefault(other, []).append(one)
    if len(links) > MAX_POINTS:
        raise InputError.at(
            "$.levels",
            f"the isolines of {level:g} have {len(links)} points: the image is too noisy there for lines",
        )
    return [[_place(values, level, edge) for edge in chain] for chain in _chains(links)]


def _segments(values: Values, level: float) -> Iterator[tuple[int, int]]:
    """Pairs of edges that a line joins. The edge to the right of value k has the number 2 k, the one down 2 k
    + 1."""
    height, width = values.shape
    if height < 2 or width < 2:
        return
    above = values >= level
    corners = (above[:-1, :-1], above[:-1, 1:], above[1:, 1:], above[1:, :-1])
    case = np.zeros(above[1:, 1:].shape, dtype=np.int64)
    for bit, corner in enumerate(corners):
        case |= corner.astype(np.int64) << bit
    middle = (values[:-1, :-1] + values[:-1, 1:] + values[1:, 1:] + values[1:, :-1]) / 4
    crossed = (case != 0) & (case != 15) & np.isfinite(middle)
    for row, column in zip(*np.nonzero(crossed), strict=True):
        kind = int(case[row, column])
        if kind in (5, 10) and middle[row, column] < level:
            kind = 15 - kind
        k = int(row) * width + int(column)
        edges = (2 * k, 2 * (k + 1) + 1, 2 * (k + width), 2 * k + 1)
        for one, other in _RUNS[kind]:
            yield edges[one], edges[other]


def _chains(links: dict[int, list[int]]) -> Iterator[list[int]]:
    """Each edge is crossed once and joins two cells at most, so all are in one chain or ring."""
    left = dict(links)
    for start in [edge for edge, joined in links.items() if len(joined) == 1] + list(links):
        if start not in left:
            continue
        chain, here = [start], start
        joined = left.pop(here)
        while True:
            following = next((edge for edge in joined if edge in left), None)
            if following is None:
                break
            chain.append(following)
            joined = left.pop(following)
        if len(links[start]) == 2 and len(chain) > 2:
            chain.append(start)
        yield chain


def _place(values: Values, level: float, edge: int) -> tuple[float, float]:
    height_width = values.shape
    (row, column), down = divmod(edge // 2, height_width[1]), edge % 2
    a = float(values[row, column])
    b = float(values[row + down, column + 1 - down])
    part = (level - a) / (b - a) if b != a else 0.5
    return column + 0.5 + (0.0 if down else part), row + 0.5 + (part if down else 0.0)


def round_levels(values: Values, wanted: int = 6) -> list[float]:
    """About so many levels of 1, 2 and 5 times powers of ten that most of the values lie around; at least one
    where anything is above 0."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if not len(known):
        return []
    low, high = np.quantile(known, [0.02, 0.98])
    powers = range(int(np.floor(np.log10(low))), int(np.floor(np.log10(high))) + 1)
    found = [float(f"{step}e{power}") for power in powers for step in (1, 2, 5)]
    inside = [level for level in found if low <= level <= high] or [float(np.median(known))]
    return inside[:: -(-len(inside) // wanted)]
