"""Commands that talk to a service."""

from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.output import (
    ERRORS,
    AsJson,
    Url,
    print_render,
    print_renders,
)
from nocturne_client.cli.watching import follow
from nocturne_client.client import Client

RenderId = Annotated[str, typer.Argument(metavar="ID", help="Id of a render, as printed by submit and list.")]
ScenePath = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene document, JSON.")]
Width = Annotated[int, typer.Option("--width", help="Pixels.")]
Height = Annotated[int, typer.Option("--height", help="Pixels.")]
Samples = Annotated[int, typer.Option("--samples", help="Samples per pixel.")]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    for command in (submit, watch, list_renders, get, cancel):
        app.command(name="list" if command is list_renders else None)(command)


def submit(
    scene: ScenePath,
    width: Width = 512,
    height: Height = 512,
    samples: Samples = 256,
    name: Annotated[str, typer.Option("--name", help="Default: the scene's own, or the file's.")] = "",
    request_id: Annotated[
        str | None,
        typer.Option("--request-id", help="Submitting again with the same id gives the same render."),
    ] = None,
    then_watch: Annotated[bool, typer.Option("--watch", help="Follow it to its end.")] = False,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Upload a scene and start rendering it; prints the render's id."""

    def uploading(path: Path, sent: int, size: int) -> None:
        if sent == size:
            ERRORS.print(f"uploaded {path.name}, {size:,} bytes", markup=False)

    with Client(url) as client:
        render = client.submit(scene, width, height, samples, name, request_id, uploading)
        if not then_watch:
            print_render(render, as_json) if as_json else typer.echo(render.id)
            return
        status = follow(client.watch(render.id), as_json)
        if not as_json:
            typer.echo(render.id)
        raise typer.Exit(status)


def watch(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Follow a render to its end."""
    with Client(url) as client:
        raise typer.Exit(follow(client.watch(render_id), as_json))


def list_renders(
    limit: Annotated[int, typer.Option("--limit", min=1, help="How many at most.")] = 20,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """List renders, newest first."""
    with Client(url) as client:
        print_renders([*client.list(limit)], as_json)


def get(
    render_id: RenderId,
    exr: Annotated[
        Path | None, typer.Option("--exr", help="Write the image here: XYZ, error, counts.")
    ] = None,
    png: Annotated[Path | None, typer.Option("--png", help="Write the preview here.")] = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Show a render, and fetch its images as they are now."""
    with Client(url) as client:
        render = client.get(render_id)
        if exr is not None:
            client.download(render_id, "exr", exr)
        if png is not None:
            client.download(render_id, "png", png)
    print_render(render, as_json)


def cancel(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Stop a render; what was merged stays and can be fetched."""
    with Client(url) as client:
        print_render(client.cancel(render_id), as_json)
