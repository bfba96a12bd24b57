"""Follows a render on the terminal."""

from collections.abc import Iterable
from dataclasses import asdict

from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from nocturne_client.cli.output import ERRORS, ExitStatus, duration, print_json
from nocturne_client.models import Render


def follow(states: Iterable[Render], as_json: bool) -> ExitStatus:
    """Shows states until the render has ended: a progress bar, or one JSON object per line."""
    last: Render | None = None
    if as_json:
        for last in states:
            print_json(asdict(last))
    else:
        last = _with_bar(states)
    if last is None or last.state in ("FAILED", "CANCELLED"):
        return ExitStatus.FAILED
    return ExitStatus.DEGRADED if last.state == "DEGRADED" else ExitStatus.OK


def _with_bar(states: Iterable[Render]) -> Render | None:
    last: Render | None = None
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[about]}"),
    )
    with Progress(*columns, console=ERRORS) as bar:
        task = bar.add_task("", total=1.0, about="")
        for last in states:
            bar.update(task, description=escape(last.name), completed=last.fraction, about=_about(last))
    if last is not None:
        ERRORS.print(escape(f"{last.id} {last.state} {last.reason}".strip()))
    return last


def _about(render: Render) -> str:
    progress = render.progress
    parts = [f"{progress.mean_samples:,.0f}/{render.samples:,} samples"]
    if progress.relative_error:
        parts.append(f"error {progress.relative_error:.2%}")
    if not render.has_ended:
        parts.append(f"{progress.photons_per_second:,.0f} photons/s")
        if render.seconds_left is not None:
            parts.append(f"{duration(render.seconds_left)} left")
        elif render.state in ("QUEUED", "PAUSED"):
            parts.append(render.state.lower())
    return ", ".join(parts)
