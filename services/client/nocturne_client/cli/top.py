"""`nocturne top`: open renders and workers, kept fresh in the terminal."""

import time

from rich.console import Console, Group
from rich.live import Live
from rich.markup import escape
from rich.table import Column, Table

from nocturne_client.cli.output import duration, time_left
from nocturne_client.client import Client
from nocturne_client.console import CONSOLE
from nocturne_client.contract import Worker, WorkOfWorker
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render

_INTERVAL_S = 2.0
_NEWEST = 200
_RECENTLY_S = 600.0


def show_top(client: Client, once: bool) -> None:
    """Until Ctrl-C, or once. The first answer must come; later ones are waited for."""
    dashboard = _dashboard(client)
    if once or not CONSOLE.is_terminal:
        Console(highlight=False, width=max(80, CONSOLE.width)).print(dashboard)
        return
    with Live(dashboard, console=CONSOLE, screen=True, auto_refresh=False) as live:
        while True:
            time.sleep(_INTERVAL_S)
            try:
                live.update(_dashboard(client), refresh=True)
            except NocturneClientError as error:
                live.update(Group(dashboard, f"[red]{escape(str(error))}[/]"), refresh=True)


def _dashboard(client: Client) -> Group:
    now = time.time()
    # Renders that ended of late stand below the open ones.
    renders = [
        each for each in client.list(_NEWEST) if not each.has_ended or now - each.created < _RECENTLY_S
    ]
    workers, work = client.workers(), client.work()
    rate = sum(worker.rays_per_second for worker in workers)
    threads = sum(worker.threads for worker in workers)
    head = f"Workers: {len(workers)}, threads: {threads}, {rate:,.0f} rays/s"
    renders.sort(key=lambda each: (each.has_ended, -each.created))
    return Group(f"[bold]{head}[/]", _of_renders(renders), "", _of_workers([*workers], [*work], now))


def _of_renders(renders: list[Render]) -> Table:
    table = Table(Column("render", no_wrap=True), *("name", "state", "done", "error", "left"), box=None)
    for render in renders:
        error = render.progress.relative_error
        table.add_row(
            render.id,
            escape(render.name),
            render.state,
            f"{render.fraction:.0%}",
            f"{error:.2%}" if error else "",
            time_left(render),
        )
    return table


def _of_workers(workers: list[Worker], work: list[WorkOfWorker], now: float) -> Table:
    table = Table(Column("worker", no_wrap=True), "threads", "rays/s", "traces", box=None)
    for worker in workers:
        traced = [
            f"{each.name or each.render}, for {duration(now - each.since)}"
            for each in work
            if each.worker == worker.id
        ]
        told = worker.quarantine or worker.drain or worker.incompatible or "; ".join(traced) or "nothing"
        table.add_row(worker.id, f"{worker.threads}", f"{worker.rays_per_second:,.0f}", escape(told))
    return table
