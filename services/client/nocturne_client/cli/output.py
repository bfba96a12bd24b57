"""What the command line prints: for people, or JSON for machines; errors on standard error."""

import json
import time
from collections.abc import Sequence
from dataclasses import asdict
from enum import IntEnum
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Column, Table

from nocturne_client.console import CONSOLE, ERRORS
from nocturne_client.contract import Group, Progress, Usage, Worker
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render
from nocturne_client.transport import DEFAULT_URL

# Of the columns other than ids, with a word of each name: together they fit into 80 columns.
_OTHER_COLUMNS_WIDTH = 64

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
    DEGRADED = 4
    INTERRUPTED = 130


def print_error(error: NocturneClientError) -> None:
    """One line for the error, one for each of its problems; none twice."""
    problems = [str(problem) for problem in error.problems]
    lines = [str(error), *(f"  {problem}" for problem in problems)]
    # An error that is no more than its problems, as the service's.
    if problems and str(error).startswith(problems[0]):
        lines = problems
    for index, line in enumerate(lines):
        ERRORS.print(f"{'' if index else '[bold red]error:[/] '}{escape(line)}", soft_wrap=True)


def print_json(value: Any) -> None:
    """JSON on one line."""
    typer.echo(json.dumps(value))


def print_render(render: Render, as_json: bool, price: Usage | None = None) -> None:
    """One render; with its price where one is given."""
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
        ("wavelengths", f"{render.first_nm:g} to {render.last_nm:g} nm"),
        ("merged", f"{render.fraction:.1%}, {progress.samples_merged:,} samples, {progress.rays:,} rays"),
        *(("warning", warning.sentence) for warning in render.warnings),
        *([("traced by", render.way)] if render.way else []),
        *([("layers", ", ".join(render.layers))] if render.layers else []),
        ("relative error", _error(progress)),
        (_mean_name(render), _mean(render)),
        ("nothing seen", f"in {progress.zero_pixels:,} of {render.width * render.height:,} pixels"),
        ("invalid samples", f"{progress.invalid_samples:,}"),
        *([("truncated paths", _truncated(progress.truncated_paths))] if progress.truncated_paths else []),
        ("processor time", _processor_time(progress, price)),
        ("stops at", _stop(render)),
        ("forecast", _forecast(render)),
        *([("out of reach", render.target_unreachable)] if render.target_unreachable else []),
        *([("tags", ", ".join(render.tags))] if render.tags else []),
        ("priority", f"{render.priority}" + (f", for {render.owner}" if render.owner else "")),
        ("audited", _audited(progress)),
        ("scene", render.scene_sha256),
        ("engine", f"{render.engine}"),
        ("floating-point profile", render.floating_point_profile or "not known yet"),
    ):
        table.add_row(f"[dim]{name}[/]", escape(text))
    CONSOLE.print(table)


def _audited(progress: Progress) -> str:
    missing = f", {progress.unaudited:,} more by no other machine yet" if progress.unaudited else ""
    return f"{progress.audited:,} ranges{missing}; results refused: {progress.refused:,}"


def _processor_time(progress: Progress, price: Usage | None) -> str:
    """In seconds, then in core hours and money where an hour has a price."""
    seconds = f"{progress.cpu_seconds:,.1f} s"
    if price is None or not price.core_hour_price:
        return seconds
    hours = progress.cpu_seconds / 3600.0
    return f"{seconds}, {hours:,.3g} core hours, {money(hours * price.core_hour_price, price.currency)}"


def money(amount: float, currency: str) -> str:
    """With more digits where it is below a hundredth."""
    return f"{amount:,.2f} {currency}" if amount >= 0.01 or not amount else f"{amount:.2g} {currency}"


def print_usage(usage: Usage) -> None:
    """A table of owners, most processor time first."""
    prices = ["cost"] if usage.core_hour_price else []
    columns = ("owner", "share now", "weight", "open", "renders", "core hours", *prices, "on disk")
    table = Table(*columns, box=None, pad_edge=False)
    for each in usage.owners:
        table.add_row(
            escape(each.owner or "(nobody)"),
            f"{each.share:.0%}",
            f"{each.weight}",
            f"{each.open_renders:,}",
            f"{each.renders:,}",
            f"{each.cpu_seconds / 3600.0:,.3g}",
            *([money(each.cost, usage.currency)] if prices else []),
            f"{each.stored_bytes / 1e6:,.1f} MB",
        )
    CONSOLE.print(table if usage.owners else "no renders yet")


def _error(progress: Progress) -> str:
    """The relative error, and why it is not to be trusted, if so."""
    if not progress.relative_error:
        return progress.error_warning or "not known yet"
    error = f"{progress.relative_error:.3%}"
    return f"{error}, not to be trusted: {progress.error_warning}" if progress.error_warning else error


def _mean_name(render: Render) -> str:
    """A sensor of one pixel has a value, and no mean."""
    quantity = render.quantity or "Y"
    return quantity if render.width * render.height == 1 else f"mean {quantity}"


def _mean(render: Render) -> str:
    """The mean over pixels and its 95 % interval."""
    progress = render.progress
    if not progress.mean:
        return "-"
    interval = f" +- {1.96 * progress.mean_error:.2g}" if progress.mean_error else ""
    return f"{progress.mean:.5g}{interval} {render.unit} (95 %)".replace("  ", " ")


def _truncated(paths: int) -> str:
    return f"{paths:,} photons, ended by the tracer's limit of interactions: the image is too dark"


def _stop(render: Render) -> str:
    """What ends it, besides samples."""
    stop = render.stop
    parts = [
        f"relative error {stop.relative_error:.3%}" if stop.relative_error else "",
        f"relative error {stop.tile_relative_error:.3%} of each tile" if stop.tile_relative_error else "",
        f"{stop.wall_seconds:g} s of running" if stop.wall_seconds else "",
        f"{stop.cpu_seconds / 3600:g} h of processor time" if stop.cpu_seconds else "",
        stop.until,
    ]
    return ", ".join(part for part in parts if part) or "its last sample"


def _forecast(render: Render) -> str:
    progress = render.progress
    if render.has_ended or not progress.predicted_end:
        return "-"
    end = time.strftime("%Y-%m-%d %H:%M", time.localtime(progress.predicted_end))
    return f"ends {end}, {progress.predicted_cpu_seconds / 3600:,.2f} h of processor time in all"


def group_sentence(group: Group) -> str:
    """How far a group is."""
    told = f"{group.name}: {group.ended} of {group.renders} renders have ended, {group.fraction:.1%} is done"
    failed = f"; {group.failed} failed or were cancelled" if group.failed else ""
    left = max(0.0, group.predicted_end - time.time()) if group.predicted_end else 0.0
    return f"{told}{failed}, {group.cpu_seconds / 3600:,.2f} h of processor time" + (
        f"; those that run end in {duration(left)}." if left else "."
    )


def print_workers(workers: list[Worker], as_json: bool) -> None:
    """A list of workers; as JSON one per line."""
    if as_json:
        for worker in workers:
            print_json(asdict(worker))
        return
    table = Table(
        Column("id", no_wrap=True),
        *("engine", "profile", "threads", "rays/s", "jobs", "up", "gets no jobs because"),
        box=None,
        pad_edge=False,
    )
    for worker in workers:
        table.add_row(
            escape(worker.id),
            f"{worker.engine}",
            escape(worker.floating_point_profile),
            f"{worker.threads}",
            f"{worker.rays_per_second:,.0f}",
            f"{worker.jobs_done:,}",
            duration(time.time() - worker.started),
            escape(_no_jobs(worker)),
        )
    _print_table(table, [worker.id for worker in workers], "no worker was heard of in the last ten seconds")
    for worker in workers:
        if worker.unaudited:
            CONSOLE.print(escape(f"{worker.id}: {worker.unaudited}"))


def _no_jobs(worker: Worker) -> str:
    """Why it gets none; empty: it gets them."""
    if worker.quarantine:
        return f"Quarantine: {worker.quarantine}"
    drained = {"draining": "Draining: it finishes its jobs.", "drained": "Drained: it has none."}
    return drained.get(worker.drain, worker.incompatible)


def print_renders(renders: list[Render], as_json: bool) -> None:
    """A list of renders; as JSON one per line."""
    if as_json:
        for render in renders:
            print_json(asdict(render))
        return
    if not renders:
        CONSOLE.print("no renders yet; start one with `nocturne submit SCENE`")
        return
    rows = [_row_of(render) for render in renders]
    widths = [max(map(len, column)) for column in zip(_LIST, *rows, strict=True)]
    others = sum(widths) - widths[1] + 2 * (len(_LIST) - 1)
    # As much of the names as there is room for: all else is typed again, or compared.
    width = max(CONSOLE.width, others + len(_LIST[1]))
    name = Column(_LIST[1], no_wrap=True, overflow="ellipsis", max_width=width - others)
    columns = [Column(text, no_wrap=True) for text in _LIST]
    table = Table(columns[0], name, *columns[2:], box=None, pad_edge=False)
    for row in rows:
        table.add_row(*(escape(text) for text in row))
    # Lines that are too long for the terminal go on in its next one.
    Console(highlight=False, width=width).print(table)
    if any(render.progress.error_warning for render in renders):
        ERRORS.print("[dim]? the error is not to be trusted; `nocturne get ID` says why[/]")
    if any(render.target_unreachable for render in renders):
        ERRORS.print("[dim]! will end without the error asked for; `nocturne get ID` says by how much[/]")


_LIST = ("id", "name", "state", "film", "done", "error", "left", "age")


def _row_of(render: Render) -> tuple[str, ...]:
    """As `nocturne list` shows it."""
    error = render.progress.relative_error
    return (
        render.id,
        render.name,
        render.state,
        f"{render.width}x{render.height}",
        f"{render.fraction:.0%}",
        f"{error:.2%}{'?' if render.progress.error_warning else ''}" if error else "",
        time_left(render) + ("!" if render.target_unreachable else ""),
        duration(time.time() - render.created),
    )


def _print_table(table: Table, ids: Sequence[str], nothing: str) -> None:
    """A table whose first column has these ids, whole however narrow the terminal: they are typed again."""
    if not ids:
        CONSOLE.print(nothing)
        return
    needed = max(len(each) for each in ids) + _OTHER_COLUMNS_WIDTH
    # Lines that are too long for the terminal go on in its next one.
    Console(highlight=False, width=max(CONSOLE.width, needed)).print(table)


def time_left(render: Render) -> str:
    """Roughly; empty where it has ended, or nothing is predicted yet."""
    return "" if render.has_ended or render.seconds_left is None else duration(render.seconds_left)


def duration(seconds: float) -> str:
    """Roughly, for people: 42 s, 3 min, 5 h, 2 d."""
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{max(0.0, seconds):.0f} s"
