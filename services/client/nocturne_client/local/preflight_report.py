"""The preflight report for people, and as a chart."""

from math import ceil
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from nocturne_scene.simplify.choosing import budgets, verdict
from nocturne_scene.simplify.pilot import RENDERS
from nocturne_scene.simplify.search import Preflight
from nocturne_scene.simplify.statistics import Interval
from rich import markup
from rich.table import Table

# Told apart by people who do not see colours alike: Okabe and Ito, "Color Universal Design", 2008.
_COLOURS = ("#000000", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 860, 440, 70, 300, 40, 50


def table(found: Preflight) -> Table:
    """All models with one part less."""
    target, pixels = found.request.error, found.pixels
    rows = Table(
        "",
        "mean luminance",
        "relative RMSE",
        "time a sample",
        f"time to {target:g}",
        box=None,
        pad_edge=False,
    )
    full = _time(found.full.seconds_for(target, pixels))
    rows.add_row("the full model", "", "", "", full)
    for model in found.models:
        said = verdict(model, target)
        rows.add_row(
            markup.escape(model.name),
            _signed(model.bias.mean),
            _percent(model.bias.local),
            f"{model.cost.value:.0%} ± {model.cost.high - model.cost.value:.0%}",
            f"[green]{_time(model.seconds_for(target, pixels))}[/]"
            if said in ("not needed", "same image")
            else f"[dim]{said}[/]",
        )
    return rows


def summary(found: Preflight) -> list[str]:
    """The conclusions, in sentences."""
    request, chosen = found.request, found.chosen
    lines = [
        f"pilot: {found.film[0]} x {found.film[1]} pixels, {RENDERS} times {found.samples} samples of each "
        f"model, {found.cpu_s:.0f} s of processor time; what is finer than its pixels it does not see"
    ]
    if found.without_effect:
        lines.append(f"makes no difference to what is traced: {'; '.join(found.without_effect)}")
    if found.rare:
        lines.append(
            "rare samples carry the noise, so neither intervals nor times are to be trusted, and nothing is "
            "chosen; a larger --budget may show enough of them"
        )
        return lines
    if found.wanted_s:
        lines.append(
            "the pilot is too short to see biases of half of the target; about "
            f"--budget {ceil(found.wanted_s)} would do"
        )
    seconds = chosen.seconds_for(request.error, found.pixels)
    samples = chosen.samples_for(request.error)
    if chosen.parts:
        lines.append(
            f"enough for {request.error:.3g}: {chosen.name}; {found.saving:.1f} times faster than the full "
            "model"
        )
    else:
        lines.append(f"nothing simpler is known to be faster within {request.error:.3g}")
    lines.append(
        f"{samples:.0f} samples for {request.width} x {request.height} pixels, {_time(seconds)} of one "
        "processor"
    )
    return lines


def _signed(interval: Interval) -> str:
    return f"{interval.value:+.2%} ± {interval.high - interval.value:.2%}"


def _percent(interval: Interval) -> str:
    return f"{interval.value:.2%} ({interval.low:.2%} to {interval.high:.2%})"


def _time(seconds: float) -> str:
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds:.3g} s"


def write_chart(found: Preflight, name: str, file: Path) -> None:
    """Total error over processor time, SVG: the full model, the chosen one and the fastest of the others."""
    target, pixels = found.request.error, found.pixels
    others = sorted(found.models, key=lambda model: model.seconds_for(target, 1))
    models = [found.full, *([found.chosen] if len(found.chosen.parts) > 1 else []), *others][: len(_COLOURS)]
    times = list(budgets(models, target, pixels, 60))
    # Far below the target nobody looks; noise may be nothing there.
    curves = [[max(model.error_after(time, pixels), target / 16) for time in times] for model in models]
    x = _Axis(times, _LEFT, _WIDTH - _RIGHT)
    y = _Axis([target, *(error for curve in curves for error in curve)], _HEIGHT - _BOTTOM, _TOP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" font-family="sans-serif" '
        'font-size="12">',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="white"/>',
        _text(_LEFT, 22, f"{name}: bias and noise together"),
        _text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 12, "processor time, s", "middle"),
        _text(12, _TOP - 6, "relative error"),
    ]
    for tick in x.ticks():
        parts.append(_line([(x.at(tick), _TOP), (x.at(tick), _HEIGHT - _BOTTOM)], "#ddd", 1))
        parts.append(_text(x.at(tick), _HEIGHT - _BOTTOM + 18, f"{tick:g}", "middle"))
    for tick in y.ticks():
        parts.append(_line([(_LEFT, y.at(tick)), (_WIDTH - _RIGHT, y.at(tick))], "#ddd", 1))
        parts.append(_text(_LEFT - 6, y.at(tick) + 4, f"{tick:g}", "end"))
    parts.append(_line([(_LEFT, y.at(target)), (_WIDTH - _RIGHT, y.at(target))], "#888", 2))
    for row, (model, curve, colour) in enumerate(zip(models, curves, _COLOURS, strict=False)):
        parts.append(_line([(x.at(a), y.at(b)) for a, b in zip(times, curve, strict=True)], colour, 2))
        parts.append(_text(_WIDTH - _RIGHT + 12, _TOP + 10 + 20 * row, model.name, colour=colour))
    parts.append(_text(_WIDTH - _RIGHT + 12, _TOP + 10 + 20 * len(models), "the target", colour="#888"))
    file.write_text("\n".join([*parts, "</svg>", ""]))


class _Axis:
    """Logarithmic, between two places of the picture."""

    def __init__(self, values: list[float], begin: float, end: float) -> None:
        self._low, self._high = np.log10(min(values)), np.log10(max(values))
        self._begin, self._end = begin, end

    def at(self, value: float) -> float:
        part = (np.log10(value) - self._low) / max(self._high - self._low, 1e-9)
        return round(float(self._begin + part * (self._end - self._begin)), 1)

    def ticks(self) -> list[float]:
        """Powers of ten."""
        return [10.0**power for power in range(ceil(self._low), int(np.floor(self._high)) + 1)]


def _text(x: float, y: float, text: str, anchor: str = "start", colour: str = "black") -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'


def _line(points: list[tuple[float, float]], colour: str, width: int) -> str:
    places = " L".join(f"{x} {y}" for x, y in points)
    return f'<path d="M{places}" fill="none" stroke="{colour}" stroke-width="{width}"/>'
