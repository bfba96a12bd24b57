"""Commands for renders that another queue runs. They import their modules when they run."""

from pathlib import Path
from typing import Annotated

import typer

from nocturne_client.cli.scene_options import (
    DEFAULT_EDGE,
    AllowMissing,
    AnyScenePath,
    BandEdges,
    FilmHeight,
    FilmWidth,
    LayerNames,
    Light,
    Samples,
    Settings,
    changes_of,
    layer_names,
)
from nocturne_client.console import ERRORS


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    for command in (openjd, join):
        app.command()(command)


def openjd(
    scene: AnyScenePath,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Job folder to write.")],
    parts: Annotated[int, typer.Option("--parts", min=1, max=10_000, help="Tasks that trace.")] = 16,
    width: FilmWidth = None,
    height: FilmHeight = None,
    samples: Samples = 256,
    layers: LayerNames = "",
    bands: BandEdges = "",
    settings: Settings = None,
    light: Light = "",
    allow_missing: AllowMissing = False,
) -> None:
    """Write a render as a job of Open Job Description: DIR/template.json, for a queue that is not ours.

    Each task runs `nocturne-trace`; the last one, `nocturne join`, makes DIR/image.exr, as of a run alone.
    """
    from nocturne_client.local.compiled import compile_to
    from nocturne_client.local.importing import imported_or_same
    from nocturne_client.local.parts import write_template

    names, changes = layer_names(layers), changes_of(settings, bands, layers)
    with imported_or_same(scene, light, allow_missing, DEFAULT_EDGE) as (document, film):
        edges = film[0] if width is None else width, film[1] if height is None else height
        compiled = compile_to(document, output, *edges, samples, None, names, changes, f"{scene}")
    for line in compiled.said():
        typer.echo(line, err=True)
    typer.echo(write_template(compiled, scene.stem, parts))


def join(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Job folder, all of whose parts are traced.")],
    output: Annotated[
        list[Path],
        typer.Option("--output", "-o", metavar="OUT.exr|.png", help="Where the image goes; may be repeated."),
    ],
) -> None:
    """Join the parts of a job folder to its image."""
    from nocturne_client.local.parts import join as join_parts

    ERRORS.print(f"{join_parts(folder, output)}", markup=False, soft_wrap=True)
    for path in output:
        typer.echo(path)
