"""What the command line prints: for people, or JSON for machines; errors on standard error."""

import json
import time
from dataclasses import asdict
from enum import IntEnum
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Column, Table

from nocturne_client.client import DEFAULT_URL
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render

CONSOLE = Console(highlight=False)
ERRORS = Console(stderr=True, highlight=False)

Url = Annotated[
    str | None, typer.Option("--url", envvar="NOCTURNE_URL", help=f"The service; default {DEFAULT_URL}.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]


class ExitStatus(IntEnum):
    """Exit statuses of all commands."""

    OK = 0
    FAILED = 1
    WRONG = 2
    NOT_REACHED = 3
    INTERRUPTED = 130


def print_error(error: NocturneClientError) -> None:
    """One line for the error, one for each of its problems."""
    ERRORS.print(f"[bold red]error:[/] {escape(str(error))}", soft_wrap=True)
    if [str(problem) for problem in error.problems] != [str(error)]:
        for problem in error.problems:
            ERRORS.print(f"  {escape(str(problem))}", soft_wrap=True)


def print_json(value: Any) -> None:
    """JSON on one line."""
    typer.echo(json.dumps(value))


def print_render(render: Render, as_json: bool) -> None:
    """One render."""
    if as_json:
        print_json(asdict(render))
        return
    table = Table.grid("", Column(overflow="fold"), padding=(0, 2))
    progress = render.progress
    for name, text in (
        ("id", render.id),
        ("name", render.name),
        ("state", f"{render.state} {render.reason}".strip()),
        ("film", f"{render.width} x {render.height}, {render.samples} samples per pixel"),
        ("merged", f"{render.fraction:.1%}, {progress.photons:,} photons, {progress.rays:,} rays"),
        ("relative error", f"{progress.relative_error:.3%}" if progress.relative_error else "not known yet"),
        ("rejected photons", f"{progress.rejected:,}"),
        ("processor time", f"{progress.cpu_seconds:,.1f} s"),
        ("scene", render.scene_sha256),
    ):
        table.add_row(f"[dim]{name}[/]", escape(text))
    CONSOLE.print(table)


def print_renders(renders: list[Render], as_json: bool) -> None:
    """A list of renders; as JSON one per line."""
    if as_json:
        for render in renders:
            print_json(asdict(render))
        return
    table = Table("id", "name", "state", "film", "merged", "error", "age", box=None, pad_edge=False)
    for render in renders:
        error = render.progress.relative_error
        table.add_row(
            render.id,
            escape(render.name),
            render.state,
            f"{render.width}x{render.height}",
            f"{render.fraction:.0%}",
            f"{error:.2%}" if error else "",
            duration(time.time() - render.created),
        )
    CONSOLE.print(table if renders else "no renders yet; start one with `nocturne submit SCENE`")


def duration(seconds: float) -> str:
    """Roughly, for people: 42 s, 3 min, 5 h, 2 d."""
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{max(0.0, seconds):.0f} s"
