"""The preflight report for people, and as a chart."""

from math import ceil
from pathlib import Path

from nocturne_scene.simplify.choosing import Model, budgets, verdict
from nocturne_scene.simplify.pilot import RENDERS
from nocturne_scene.simplify.search import Preflight
from nocturne_scene.simplify.statistics import Interval
from rich import markup
from rich.table import Table

from nocturne_client.local.chart import Line
from nocturne_client.local.chart import write_chart as write_log_chart

_MAX_CURVES = 7


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
    models = [found.full, *([found.chosen] if len(found.chosen.parts) > 1 else []), *others][:_MAX_CURVES]
    times = list(budgets(models, target, pixels, 60))

    def curve(model: Model) -> Line:
        # Far below the target nobody looks; noise may be nothing there.
        points = [(time, max(model.error_after(time, pixels), target / 16)) for time in times]
        return Line(model.name, points, is_curve=True)

    lines = [Line("the target", [(times[0], target), (times[-1], target)], is_curve=True)]
    lines += [curve(model) for model in models]
    write_log_chart(file, f"{name}: bias and noise together", "processor time, s", "relative error", lines)
