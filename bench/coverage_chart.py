"""The chart of error bars: how often intervals held the truth, against how often they should."""

from bench.error_bars import LEVELS, SCENES, SEQUENCES
from bench.report import Figures

_WIDTH, _HEIGHT, _LEFT, _TOP = 640, 300, 60, 20
_LEAST = 60.0
"""Per cent at the foot."""
_COLOURS = ("#1f5fa8", "#c8641e")


def coverage_chart(figures: Figures) -> str:
    """SVG: a column for each nominal level, a dot for each scene, a colour for each sampler."""
    column = (_WIDTH - _LEFT) / len(LEVELS)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT + 50}" '
        'font-family="sans-serif" font-size="13">',
        f'<rect width="{_WIDTH}" height="{_HEIGHT + 50}" fill="#fff"/>',
    ]
    for value in range(int(_LEAST), 101, 10):
        y = _height(value)
        parts.append(f'<path d="M{_LEFT} {y:.1f}H{_WIDTH}" stroke="#ddd"/>')
        parts.append(f'<text x="{_LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{value} %</text>')
    for index, level in enumerate(LEVELS):
        left, nominal = _LEFT + column * index, float(level.removesuffix(" %"))
        y = _height(nominal)
        parts.append(f'<path d="M{left + 20:.1f} {y:.1f}h{column - 40:.1f}" stroke="#222" stroke-width="2"/>')
        middle = left + column / 2
        parts.append(
            f'<text x="{middle:.1f}" y="{_HEIGHT + 5}" text-anchor="middle">should be {level}</text>'
        )
        for number, sequence in enumerate(SEQUENCES):
            for place, scene in enumerate(SCENES):
                found = figures.get(f"{scene}, {sequence}")
                if found is None:
                    continue
                x = left + 40 + (column - 80) * (place + 0.5 * number) / len(SCENES)
                held = 100 * found["coverage"][level]
                parts.append(
                    f'<circle cx="{x:.1f}" cy="{_height(held):.1f}" r="4" fill="{_COLOURS[number]}">'
                    f"<title>{scene}, {sequence}: {held:.3g} %</title></circle>"
                )
    for number, sequence in enumerate(SEQUENCES):
        x = _LEFT + 20 + 140 * number
        parts.append(f'<circle cx="{x}" cy="{_HEIGHT + 30}" r="4" fill="{_COLOURS[number]}"/>')
        parts.append(f'<text x="{x + 10}" y="{_HEIGHT + 34}">{sequence}</text>')
    return "\n".join([*parts, "</svg>\n"])


def _height(per_cent: float) -> float:
    return _TOP + (100 - per_cent) / (100 - _LEAST) * (_HEIGHT - _TOP - 20)
