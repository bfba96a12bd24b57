"""Follows a render on the terminal."""

import os
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from importlib.util import find_spec
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from nocturne_client.cli.output import ExitStatus, duration, print_json
from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render
from nocturne_client.preview.graphics import Graphics, graphics_of

if TYPE_CHECKING:
    from nocturne_client.preview.sinks import Sink


def follow(states: Iterable[Render], as_json: bool, sinks: "Sequence[Sink]" = ()) -> ExitStatus:
    """Shows states until the render has ended: a progress bar, one JSON object per line, or a picture.

    `sinks` get every state; one that is a terminal's takes the place of the bar.
    """
    last: Render | None = None
    states = _told(states, sinks)
    if as_json:
        for last in states:
            print_json(asdict(last))
    elif any(sink.is_terminal for sink in sinks):
        last = next(iter(deque(states, maxlen=1)), None)
        if last is not None:
            ERRORS.print(escape(f"{last.id} {last.state} {last.reason}".strip()))
    else:
        last = _with_bar(states)
    if last is None or last.state in ("FAILED", "CANCELLED"):
        return ExitStatus.FAILED
    return ExitStatus.DEGRADED if last.state == "DEGRADED" else ExitStatus.OK


def graphics_wanted(image: str, is_terminal: bool) -> Graphics | None:
    """How to show images, from the option --image. Raises NocturneClientError for an unknown word."""
    if image == "none":
        return None
    if image == "auto":
        # Pixels take numpy, an extra of this package.
        return graphics_of(os.environ) if is_terminal and find_spec("numpy") else None
    try:
        return Graphics(image)
    except ValueError:
        known = ", ".join(each.value for each in Graphics)
        raise NocturneClientError(f"--image {image}: expected auto, none, {known}") from None


def _told(states: Iterable[Render], sinks: "Sequence[Sink]") -> Iterator[Render]:
    for state in states:
        for sink in sinks:
            sink.show(state)
        yield state


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
            bar.update(task, description=escape(last.name), completed=last.fraction, about=about(last))
    if last is not None:
        ERRORS.print(escape(f"{last.id} {last.state} {last.reason}".strip()))
    return last


def about(render: Render) -> str:
    progress = render.progress
    parts = [f"{progress.mean_samples:,.0f}/{render.samples:,} samples"]
    if progress.relative_error:
        error_warning = " (not to be trusted)" if progress.error_warning else ""
        parts.append(f"error {progress.relative_error:.2%}{error_warning}")
    if not render.has_ended:
        parts.append(f"{progress.samples_per_second:,.0f} samples/s")
        parts.append(f"{progress.rays_per_second:,.0f} rays/s")
        if render.seconds_left is not None:
            parts.append(f"{duration(render.seconds_left)} left")
        elif render.state in ("QUEUED", "PAUSED"):
            parts.append(render.state.lower())
    return ", ".join(parts)
