"""A year of daylight as an SVG: a plan of each grid of meters, and the mean of all hours by day and hour."""

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

import numpy as np
from nocturne_scene.daylight.year_of_light import YearOfLight
from nocturne_scene.spectra.published import Floats

from nocturne_client.local.false_colour import COLOURS, step_colour

_WIDTH, _MARGIN = 760, 50
_LEGEND = 90
_LUX = (50.0, 100.0, 200.0, 300.0, 500.0, 750.0, 1000.0, 2000.0, 5000.0)
_PARTS = tuple(0.1 * i for i in range(1, 10))
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


def picture(found: YearOfLight) -> str:
    """SVG, UTF-8."""
    parts, top = list[str](), 30.0
    low, high = found.sda.low, found.sda.high
    parts.append(
        _text(_MARGIN, top, f"{found.year.name}: sDA {found.sda.value:.1%} ({low:.1%} to {high:.1%})", 15)
    )
    for name, grid in _grids(found):
        drawn, height = _plan(name, grid, top + 30)
        parts += drawn
        top += height + 60
    drawn, height = _year(found, top + 30)
    parts += drawn
    whole = top + height + 70
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {whole:.0f}" width="{_WIDTH}" '
        f'height="{whole:.0f}" font-family="sans-serif"><rect width="100%" height="100%" fill="#fff"/>'
        f"{''.join(parts)}</svg>\n"
    )


def _grids(found: YearOfLight) -> Iterator[tuple[str, Floats]]:
    """Daylight autonomy of each instrument with a grid, as its plan."""
    first = 0
    for instrument in found.points.instruments:
        columns, rows = instrument.columns, instrument.rows
        values = found.by_point["DA"].value[first : first + columns * rows]
        first += columns * rows
        if instrument.is_grid:
            yield instrument.name, values.reshape(rows, columns)


def _plan(name: str, values: Floats, top: float) -> tuple[list[str], float]:
    rows, columns = values.shape
    room = _WIDTH - 2 * _MARGIN - _LEGEND
    cell = min(room / columns, 420 / rows, 60.0)
    parts = [_text(_MARGIN, top - 8, f"{name}: daylight autonomy, % of the hours", 13)]
    for row in range(rows):
        for column in range(columns):
            x, y = _MARGIN + column * cell, top + row * cell
            colour = step_colour(values[row, column], _PARTS)
            parts.append(_rectangle(x, y, cell, cell, colour))
            if cell >= 22:
                ink = "#000" if values[row, column] > 0.6 else "#fff"
                label = f"{100 * values[row, column]:.0f}"
                parts.append(_text(x + cell / 2, y + cell / 2 + 4, label, 11, "middle", ink))
    parts += _legend(_MARGIN + columns * cell + 20, top, [f"{100 * part:.0f} %" for part in _PARTS])
    return parts, max(rows * cell, 10 * 16.0)


def _year(found: YearOfLight, top: float) -> tuple[list[str], float]:
    """Days to the right, hours upwards."""
    hours = np.rint(found.hourly.value.size / 24)
    lux = found.hourly.value.reshape(int(hours), 24)
    width = (_WIDTH - 2 * _MARGIN - _LEGEND) / len(lux)
    height = 9.0
    parts = [
        _text(_MARGIN, top - 8, "mean illuminance of the points, lx, by day and hour of standard time", 13)
    ]
    for hour in range(24):
        y = top + (23 - hour) * height
        # Equal neighbours are one rectangle.
        colours = [step_colour(value, _LUX) if value > 0 else "#111" for value in lux[:, hour]]
        first = 0
        for day in range(1, len(colours) + 1):
            if day < len(colours) and colours[day] == colours[first]:
                continue
            x = _MARGIN + first * width
            parts.append(_rectangle(x, y, (day - first) * width + 0.2, height + 0.2, colours[first]))
            first = day
    parts += [
        _text(_MARGIN - 6, top + (24 - hour) * height + 4, f"{hour}", 11, "end") for hour in range(0, 25, 6)
    ]
    bottom = top + 24 * height + 14
    begins = [int(np.argmax(found.year.month[::24] == month)) for month in range(1, 13)]
    for month, day in zip(_MONTHS, begins, strict=True):
        parts.append(_text(_MARGIN + day * width, bottom, month, 11))
    parts += _legend(_WIDTH - _MARGIN - _LEGEND + 20, top, [f"{each:g} lx" for each in _LUX])
    return parts, 24 * height


def _legend(x: float, top: float, labels: Sequence[str]) -> list[str]:
    """Steps from below, the largest above."""
    parts = []
    for i, colour in enumerate(reversed(COLOURS)):
        parts.append(_rectangle(x, top + 16 * i, 16, 16, colour))
        if i < len(labels):
            parts.append(_text(x + 22, top + 16 * (i + 1) + 4, labels[-1 - i], 11))
    return parts


def _rectangle(x: float, y: float, width: float, height: float, colour: str) -> str:
    return f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{colour}"/>'


def _text(x: float, y: float, text: str, size: int, anchor: str = "start", ink: str = "#222") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{ink}">'
        f"{escape(text)}</text>"
    )
