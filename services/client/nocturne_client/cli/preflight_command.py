"""`nocturne preflight`: what a scene needs for a target error."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.progress import Progress

from nocturne_client.cli.local_commands import Threads
from nocturne_client.cli.output import AsJson, print_json
from nocturne_client.cli.scene_options import Height, ScenePath, Width
from nocturne_client.cli.stops import share
from nocturne_client.console import CONSOLE, ERRORS


def add_to(app: typer.Typer) -> None:
    """Adds the command to the program."""
    app.command()(preflight)


def preflight(
    scene: ScenePath,
    error: Annotated[
        str, typer.Option("--error", help='Relative error that is wanted, bias and noise together: "2%".')
    ] = "2%",
    width: Width = 512,
    height: Height = 512,
    take: Annotated[
        Path | None,
        typer.Option("--take", metavar="FILE", help="Write the cheapest scene document that is enough."),
    ] = None,
    chart: Annotated[
        Path | None, typer.Option("--chart", metavar="FILE.svg", help="Draw time against total error.")
    ] = None,
    pilot: Annotated[
        int, typer.Option("--pilot", min=8, max=1024, help="Longer edge of the pilot's film, pixels.")
    ] = 64,
    budget: Annotated[
        float, typer.Option("--budget", min=1, help="Processor time for the pilot, seconds, about.")
    ] = 120.0,
    threads: Threads = 0,
    as_json: AsJson = False,
) -> None:
    """Show which parts of a scene matter: what each changes and costs, and the cheapest sufficient scene."""
    from nocturne_scene.simplify.report import as_json as report
    from nocturne_scene.simplify.search import Request

    from nocturne_client.local import preflight_report
    from nocturne_client.local.preflight import preflight_of, taken
    from nocturne_client.scene_files import read_scene

    target = share(error, "--error")
    if not target:
        raise typer.BadParameter(f"{error!r}: expected more than 0 %", param_hint="--error")
    on_disk = read_scene(scene)
    if take is not None:
        # Before the work rather than after it.
        taken(on_disk, on_disk.document, take)
    request = Request(target, width, height, pilot, budget, threads or len(os.sched_getaffinity(0)))
    with Progress(console=ERRORS) as bar:

        def say(what: str, steps: int) -> Callable[[], None]:
            task = bar.add_task(what, total=steps)
            return lambda: bar.advance(task)

        found = preflight_of(request, on_disk, say)
    if chart is not None:
        preflight_report.write_chart(found, on_disk.name or scene.stem, chart)
    if take is not None:
        document = taken(on_disk, found.document, take)
        take.write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n")
    if as_json:
        print_json(report(found))
        return
    CONSOLE.print(preflight_report.table(found))
    for line in preflight_report.summary(found):
        CONSOLE.print(line, markup=False, soft_wrap=True)
