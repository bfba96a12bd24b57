"""Lines over two logarithmic axes, as an SVG."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from xml.sax.saxutils import escape

_WIDTH, _HEIGHT = 750, 400
_LEFT, _RIGHT, _TOP, _BOTTOM = 80, 250, 40, 50
_LABEL = 14.0
_WIDEST_LABEL = 44.0
# Told apart by people who do not see colours alike: Okabe and Ito, "Color Universal Design", 2008.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
# Of the second seven lines, and so on.
_DASHES = ("", "6 3", "2 2")


@dataclass(frozen=True)
class Line:
    """Points (x, y), all more than 0, x increasing."""

    name: str
    points: Sequence[tuple[float, float]]
    is_curve: bool = False
    """Whether its points are not to be seen."""


class _Axis:
    """Logarithmic, from a pixel to a pixel, with a little room at both ends."""

    def __init__(self, values: list[float], begin: float, end: float) -> None:
        low, high = math.log10(min(values)), math.log10(max(values))
        room = 0.05 * (high - low) + 0.02
        self._low, self._high = low - room, high + room
        self._begin, self._end = begin, end

    def at(self, value: float) -> float:
        part = (math.log10(value) - self._low) / (self._high - self._low)
        return round(self._begin + part * (self._end - self._begin), 1)

    def ticks(self, room: float) -> list[float]:
        """1, 2 and 5 times powers of ten; only powers, or each second of them and so on, where labels that
        need so many pixels would lie on each other."""
        decades = range(math.floor(self._low), math.ceil(self._high) + 1)
        steps = [(1, 2, 5), (1,)]
        choices = [[factor * 10.0**decade for decade in decades for factor in step] for step in steps]
        choices += [[10.0**decade for decade in decades if decade % step == 0] for step in (2, 3, 5, 10)]
        for choice in choices:
            found = [each for each in choice if self._low <= math.log10(each) <= self._high]
            places = [self.at(each) for each in found]
            if all(abs(after - before) >= room for before, after in pairwise(places)):
                return found
        return found


def write_chart(path: Path, title: str, x_name: str, y_name: str, lines: Sequence[Line]) -> None:
    """Draws at most 21 lines into a file."""
    if len(lines) > len(_COLOURS) * len(_DASHES):
        raise ValueError(f"{len(lines)} lines; a chart has at most {len(_COLOURS) * len(_DASHES)}")
    points = [point for line in lines for point in line.points]
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    x = _Axis([point[0] for point in points], _LEFT, right)
    y = _Axis([point[1] for point in points], bottom, _TOP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="white"/>',
        _text(_LEFT, 22, title),
        _text((_LEFT + right) / 2, _HEIGHT - 12, x_name, "middle"),
        _text(12, _TOP - 6, y_name),
    ]
    for tick in x.ticks(_WIDEST_LABEL):
        parts.append(_path([(x.at(tick), _TOP), (x.at(tick), bottom)], "#ddd", 1))
        parts.append(_text(x.at(tick), bottom + 18, f"{tick:g}", "middle"))
    for tick in y.ticks(_LABEL):
        parts.append(_path([(_LEFT, y.at(tick)), (right, y.at(tick))], "#ddd", 1))
        parts.append(_text(_LEFT - 6, y.at(tick) + 4, f"{tick:g}", "end"))
    ends = []
    for number, line in enumerate(lines):
        colour, dash = _COLOURS[number % len(_COLOURS)], _DASHES[number // len(_COLOURS)]
        places = [(x.at(a), y.at(b)) for a, b in line.points]
        parts.append(_path(places, colour, 2, dash))
        if not line.is_curve:
            parts += [f'<circle cx="{a}" cy="{b}" r="3.5" fill="{colour}"/>' for a, b in places]
        ends.append((places[-1][1], line.name, colour))
    heights = _apart([end[0] for end in ends], _TOP, bottom)
    for height, (_, name, colour) in zip(heights, ends, strict=True):
        parts.append(_text(right + 8, height + 4, name, colour=colour))
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join([*parts, "</svg>", ""]))


def _apart(heights: Sequence[float], top: float, bottom: float) -> list[float]:
    """Moves labels by as little as needed that none lies on another, in the order that they have."""
    order = sorted(range(len(heights)), key=lambda index: heights[index])
    moved = list(heights)
    last = top - _LABEL
    for index in order:
        last = moved[index] = max(heights[index], last + _LABEL)
    last = bottom + _LABEL
    for index in reversed(order):
        last = moved[index] = round(min(moved[index], last - _LABEL), 1)
    return moved


def _text(x: float, y: float, text: str, anchor: str = "start", colour: str = "black") -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'


def _path(points: Sequence[tuple[float, float]], colour: str, width: int, dash: str = "") -> str:
    places = " L".join(f"{x} {y}" for x, y in points)
    dashes = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="M{places}" fill="none" stroke="{colour}" stroke-width="{width}"{dashes}/>'
