"""The plan of a grid of meters: false colour, values, isolines, and the room below."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from nocturne_scene.photometry.isolines import isolines

from nocturne_client.local.false_colour import COLOURS, ink_on, step_colour
from nocturne_client.local.report.drawing import Drawing, Line, Text
from nocturne_client.local.report.grid_values import GridValues, Values
from nocturne_client.local.report.plan_lines import Frame, PlanLines, clipped

LEVELS = (50.0, 100.0, 200.0, 300.0, 500.0, 750.0, 1000.0, 2000.0, 5000.0)
"""lx, of colours and lines."""
_WIDTH, _HEIGHT = 170.0, 130.0
"""mm, at most, of the plan and its legend."""
_LEGEND, _MARGIN = 24.0, 7.0
_AROUND = 0.35
"""Of the grid's longer side, how far beyond it the room is looked for."""
_LEAST_CELL = 5.5
"""mm, in which a value can be read."""
_FINER = 4
"""Straight lines between values are followed in so many steps."""


def plan(grid: GridValues, frame: Frame, lines: PlanLines, title: str) -> Drawing:
    """Of a grid with values in lx."""
    box = _box(frame, lines)
    left, bottom, right, top = box
    room = _WIDTH - _LEGEND - _MARGIN, _HEIGHT - 2 * _MARGIN
    scale = min(room[0] / (right - left), room[1] / (top - bottom))
    height = (top - bottom) * scale
    drawing = Drawing(_WIDTH, max(height, 9.0 + 5.0 * len(COLOURS)) + 2 * _MARGIN, title=title)

    def at(x: float, y: float) -> tuple[float, float]:
        return _MARGIN + (x - left) * scale, _MARGIN + (top - y) * scale

    rows, columns = grid.values.shape
    cell = frame.width / columns, frame.height / rows
    _put_colours(drawing, grid.values, cell, scale, at(0.0, frame.height))
    for segments, colour, width in (
        (lines.below, "#111111", 0.2),
        (lines.cut, "#000000", 0.6),
        (lines.lamps, "#d9480f", 0.4),
    ):
        for x0, y0, x1, y1 in clipped(sorted(segments), box):
            drawing.add(Line((at(x0, y0), at(x1, y1)), colour, width, dashed=segments is lines.lamps))
    labels = _put_isolines(drawing, grid, cell, at(0.0, frame.height), scale)
    if min(cell) * scale >= _LEAST_CELL:
        _put_values(drawing, grid.values, cell, at(0.0, frame.height), scale)
    drawing.add(*labels)
    _put_scale(drawing, (left, right), scale, _MARGIN + height)
    _put_legend(drawing, _WIDTH - _LEGEND + 4.0)
    return drawing


def _box(frame: Frame, lines: PlanLines) -> tuple[float, float, float, float]:
    """Around the grid, and what of the room is cut or hangs near it."""
    reach = _AROUND * max(frame.width, frame.height)
    near = -reach, -reach, frame.width + reach, frame.height + reach
    found = [(0.0, 0.0, frame.width, frame.height), *clipped([*lines.cut, *lines.lamps], near)]
    xs = [each for segment in found for each in segment[::2]]
    ys = [each for segment in found for each in segment[1::2]]
    slack = 0.02 * max(frame.width, frame.height)
    return min(xs) - slack, min(ys) - slack, max(xs) + slack, max(ys) + slack


def _put_colours(
    drawing: Drawing,
    values: Values,
    cell: tuple[float, float],
    scale: float,
    corner: tuple[float, float],
) -> None:
    wide, high = cell[0] * scale, cell[1] * scale
    for row, of_row in enumerate(values):
        colours = [step_colour(each, LEVELS) if math.isfinite(each) else "#ffffff" for each in of_row]
        first = 0
        for column in range(1, len(colours) + 1):
            # Equal neighbours are one area.
            if column < len(colours) and colours[column] == colours[first]:
                continue
            x, y = corner[0] + first * wide, corner[1] + row * high
            drawing.rectangle(x, y, (column - first) * wide + 0.03, high + 0.03, colours[first])
            first = column


def _put_values(
    drawing: Drawing, values: Values, cell: tuple[float, float], corner: tuple[float, float], scale: float
) -> None:
    wide, high = cell[0] * scale, cell[1] * scale
    size = min(2.8, 0.3 * wide, 0.45 * high)
    for row, of_row in enumerate(values):
        for column, value in enumerate(of_row):
            if math.isfinite(value):
                ink = ink_on(step_colour(value, LEVELS))
                x, y = corner[0] + (column + 0.5) * wide, corner[1] + (row + 0.5) * high + 0.35 * size
                drawing.add(Text(x, y, _lux(value), size, "middle", ink))


def _put_isolines(
    drawing: Drawing, grid: GridValues, cell: tuple[float, float], corner: tuple[float, float], scale: float
) -> list[Text]:
    """Between the middles of cells; gives their labels."""
    labels = list[Text]()
    if min(grid.values.shape) < 2 or not np.isfinite(grid.values).all():
        return labels
    fine = _finer(grid.calmed, _FINER if max(grid.values.shape) <= 64 else 1)
    steps = [(count - 1) / (had - 1) for count, had in zip(fine.shape, grid.values.shape, strict=True)]
    for level in LEVELS:
        for line in isolines(fine, level):
            places = [
                (
                    corner[0] + ((x - 0.5) / steps[1] + 0.5) * cell[0] * scale,
                    corner[1] + ((y - 0.5) / steps[0] + 0.5) * cell[1] * scale,
                )
                for x, y in line
            ]
            drawing.add(Line(places, "#ffffff", 0.7), Line(places, "#b3001b", 0.35))
            if _length(places) > 12.0:
                x, y = places[len(places) // 2]
                labels.append(Text(x, y + 0.9, f"{level:g}", 2.5, "middle", "#b3001b", bold=True, halo=True))
    return labels


def _finer(values: Values, factor: int) -> Values:
    """With values on straight lines between neighbours."""
    rows, columns = values.shape
    down = np.linspace(0.0, rows - 1.0, factor * (rows - 1) + 1)
    across = np.linspace(0.0, columns - 1.0, factor * (columns - 1) + 1)
    wide = np.stack([np.interp(across, np.arange(columns), each) for each in values])
    return np.stack([np.interp(down, np.arange(rows), each) for each in wide.T], axis=1)


def _length(points: Sequence[tuple[float, float]]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(points))


def _put_scale(drawing: Drawing, ends: tuple[float, float], scale: float, y: float) -> None:
    """A bar of a round number of metres."""
    wanted = 0.25 * (ends[1] - ends[0])
    power = 10.0 ** math.floor(math.log10(wanted))
    metres = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)
    places = (_MARGIN, y + 2.5), (_MARGIN + metres * scale, y + 2.5)
    drawing.add(Line(places, "#000000", 0.6))
    drawing.add(Text(places[1][0] + 1.5, y + 3.4, f"{metres:g} m", 2.6))


def _put_legend(drawing: Drawing, x: float) -> None:
    """Steps from below, the largest above."""
    drawing.add(Text(x, _MARGIN + 2.5, "lx", 2.8, bold=True))
    for index, colour in enumerate(reversed(COLOURS)):
        y = _MARGIN + 4.0 + 5.0 * index
        drawing.rectangle(x, y, 5.0, 5.0, colour)
        if index < len(LEVELS):
            drawing.add(Text(x + 6.5, y + 6.0, f"{LEVELS[-1 - index]:g}", 2.6))


def _lux(value: float) -> str:
    """Three digits that count."""
    return f"{float(f'{value:.3g}'):g}"
