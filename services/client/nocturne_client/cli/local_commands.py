"""Commands that work on this machine. They import what they need when they run: the others start fast."""

import os
from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.output import CONSOLE, AsJson, print_json
from nocturne_client.cli.service_commands import Height, Samples, ScenePath, Width

Threads = Annotated[int, typer.Option("--threads", min=0, help="0: one per processor.")]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    for command in (up, render, ies, compile_scene, doctor):
        app.command(name="compile" if command is compile_scene else None)(command)


def up(
    data: Annotated[
        Path | None, typer.Option("--data", help="Data folder: renders, images, assets. Default: yours.")
    ] = None,
    port: Annotated[
        int, typer.Option("--port", min=1, max=65534, help="Page and REST; gRPC is one above.")
    ] = 7070,
    workers: Annotated[int, typer.Option("--workers", min=0, help="Worker processes.")] = 1,
    threads: Annotated[
        int, typer.Option("--threads", min=0, help="Per worker; 0: share the processors.")
    ] = 0,
) -> None:
    """Run the whole service here: redis-server, coordinator, API with page, workers. Ctrl-C stops it."""
    from nocturne_client.local.up import UpSettings, default_data_folder, run_up

    share = max(1, len(os.sched_getaffinity(0)) // max(1, workers))
    run_up(UpSettings((data or default_data_folder()).absolute(), port, workers, threads or share))


def render(
    scene: ScenePath,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT.exr", help="Where the image goes.")],
    width: Width = 512,
    height: Height = 512,
    samples: Samples = 256,
    threads: Threads = 0,
) -> None:
    """Render one scene on this machine without a service; the same bits as from the service."""
    from nocturne_client.local.render import render_scene

    render_scene(scene, output, width, height, samples, threads or len(os.sched_getaffinity(0)))
    typer.echo(output)


def ies(
    image: Annotated[Path, typer.Argument(metavar="IMAGE.exr", help="Of an intensity meter.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE.ies", help="Where the file goes.")],
) -> None:
    """Write the image of an intensity meter as a photometric file, LM-63-2002, in candelas."""
    from nocturne_client.local.photometry import write_photometry

    write_photometry(image, output)
    typer.echo(output)


def compile_scene(
    scene: ScenePath,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")],
    width: Width = 512,
    height: Height = 512,
    samples: Samples = 256,
) -> None:
    """Compile a scene for `nocturne-trace`: DIR/scene.pb, DIR/plan.pb and DIR/blobs/."""
    from nocturne_client.local.compiled import compile_to

    compiled = compile_to(scene, output, width, height, samples)
    typer.echo(compiled.scene_sha256)


def doctor(as_json: AsJson = False) -> None:
    """Say what is missing on this machine and how to get it. Exit status 1 if something needed is."""
    from nocturne_client.local.doctor import examine, table_of

    findings = examine()
    if as_json:
        print_json([vars(finding) for finding in findings])
    else:
        CONSOLE.print(table_of(findings))
    raise typer.Exit(int(any(finding.needed and not finding.ok for finding in findings)))
