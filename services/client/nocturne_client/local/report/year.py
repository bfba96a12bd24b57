"""A year of daylight as drawings: mean illuminance by day and hour, and points by their daylight autonomy."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from nocturne_client.local.false_colour import COLOURS, step_colour
from nocturne_client.local.report.drawing import Drawing, Line, Text

LEVELS = (50.0, 100.0, 200.0, 300.0, 500.0, 750.0, 1000.0, 2000.0, 5000.0)
_WIDTH, _LEFT, _TOP = 170.0, 9.0, 6.0
_WIDE, _HIGH = 0.365, 2.0
"""mm, of a day and of an hour."""
_DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_NIGHT = "#111111"
_BINS = 10


def year_drawings(annual: Mapping[str, Any]) -> list[Drawing]:
    """Of what `nocturne annual` wrote; none of files that have no hours."""
    drawings = []
    lux = annual.get("hourly")
    if isinstance(lux, list) and len(lux) == 24 * sum(_DAYS):
        drawings.append(heat_map(np.array(lux, dtype=np.float64).reshape(-1, 24).tolist()))
    parts = [point["DA"]["value"] for point in annual.get("points", ()) if "DA" in point]
    if len(parts) > 1:
        drawings.append(histogram(parts))
    return drawings


def heat_map(lux: Sequence[Sequence[float]]) -> Drawing:
    """By day and hour, days to the right and hours upwards; lx."""
    drawing = Drawing(_WIDTH, _TOP + 24 * _HIGH + 7.0, title="mean illuminance by day and hour, lx")
    drawing.add(Text(_LEFT, 4.0, "mean illuminance of the points by day and hour of standard time", 2.6))
    for hour in range(24):
        y = _TOP + (23 - hour) * _HIGH
        colours = [step_colour(day[hour], LEVELS) if day[hour] > 0.0 else _NIGHT for day in lux]
        first = 0
        for day in range(1, len(colours) + 1):
            # Equal neighbours are one area.
            if day < len(colours) and colours[day] == colours[first]:
                continue
            drawing.rectangle(_LEFT + first * _WIDE, y, (day - first) * _WIDE, _HIGH, colours[first])
            first = day
    for hour in range(0, 25, 6):
        drawing.add(Text(_LEFT - 1.0, _TOP + (24 - hour) * _HIGH + 0.9, f"{hour}", 2.4, "end"))
    day = 0
    for name, days in zip(_MONTHS, _DAYS, strict=True):
        drawing.add(Text(_LEFT + day * _WIDE, _TOP + 24 * _HIGH + 3.5, name, 2.4))
        day += days
    x = _LEFT + len(lux) * _WIDE + 4.0
    for index, colour in enumerate(reversed(COLOURS)):
        drawing.rectangle(x, _TOP + 4.6 * index, 4.0, 4.6, colour)
        if index < len(LEVELS):
            label = f"{LEVELS[-1 - index]:g}{' lx' if index == 0 else ''}"
            drawing.add(Text(x + 5.0, _TOP + 4.6 * (index + 1) + 0.9, label, 2.4))
    return drawing


def histogram(parts: Sequence[float]) -> Drawing:
    """Points by their daylight autonomy, a part of the hours."""
    counts, _ = np.histogram(np.clip(parts, 0.0, 1.0), _BINS, (0.0, 1.0))
    high, wide = 24.0, 11.0
    drawing = Drawing(_WIDTH, _TOP + high + 12.0, title="points by their daylight autonomy")
    drawing.add(Text(_LEFT, 4.0, "points by their daylight autonomy, % of the hours", 2.6))
    for index, count in enumerate(counts.tolist()):
        tall = high * count / max(counts.max(), 1)
        x, y = _LEFT + index * wide, _TOP + high + 4.0
        drawing.rectangle(x + 0.5, y - tall, wide - 1.0, tall, COLOURS[3])
        if count:
            drawing.add(Text(x + 0.5 * wide, y - tall - 0.8, f"{count}", 2.4, "middle"))
        drawing.add(Text(x, y + 3.5, f"{100 * index // _BINS}", 2.4, "middle"))
    drawing.add(Text(_LEFT + _BINS * wide, _TOP + high + 7.5, "100", 2.4, "middle"))
    ends = (_LEFT, _TOP + high + 4.0), (_LEFT + _BINS * wide, _TOP + high + 4.0)
    drawing.add(Line(ends, "#222222", 0.3))
    return drawing
