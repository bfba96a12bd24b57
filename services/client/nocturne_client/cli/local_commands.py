"""Commands that work on this machine. They import their modules when they run: the others start fast."""

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from nocturne_client.cli.output import AsJson, print_json
from nocturne_client.cli.scene_options import (
    DEFAULT_EDGE,
    AllowMissing,
    AnyScenePath,
    BandEdges,
    FilmHeight,
    FilmWidth,
    Height,
    LayerNames,
    Light,
    Samples,
    ScenePath,
    Settings,
    Width,
    changes_of,
    layer_names,
)
from nocturne_client.cli.stops import Error, For, Stops
from nocturne_client.console import CONSOLE, ERRORS

Threads = Annotated[int, typer.Option("--threads", min=0, help="0: one per processor.")]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    names = {
        compile_scene: "compile",
        import_scene: "import",
        export_scene: "export",
    }
    commands = (render, ies, ugr, compile_scene, import_scene, export_scene, doctor, restore, database)
    for command in commands:
        app.command(name=names.get(command))(command)


def render(
    scene: AnyScenePath,
    output: Annotated[
        list[Path],
        typer.Option("--output", "-o", metavar="OUT.exr|.png", help="Where the image goes; may be repeated."),
    ],
    width: FilmWidth = None,
    height: FilmHeight = None,
    samples: Samples = 256,
    threads: Threads = 0,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Seed instead of the scene's own.")
    ] = None,
    statistics: Annotated[
        Path | None, typer.Option("--statistics", metavar="OUT.json", help="Write counts and times here.")
    ] = None,
    error: Error = "",
    duration: For = "",
    layers: LayerNames = "",
    bands: BandEdges = "",
    settings: Settings = None,
    light: Light = "",
    allow_missing: AllowMissing = False,
) -> None:
    """Render one scene on this machine without a service; the same bits as from the service.

    With --error or --for it ends where a range of samples does: at the last one that fits into the time.
    """
    from nocturne_client.local.importing import imported_or_same
    from nocturne_client.local.render import LocalRender, render_scene
    from nocturne_client.outputs import is_standard_output

    stop = Stops(error, duration=duration).asked()
    threads = threads or len(os.sched_getaffinity(0))
    names, changes = layer_names(layers), changes_of(settings, bands, layers)
    with imported_or_same(scene, light, allow_missing, DEFAULT_EDGE) as (document, film):
        # 0 is refused, and not taken for nothing.
        edges = film[0] if width is None else width, film[1] if height is None else height
        asked = LocalRender(
            document, output, *edges, samples, threads, seed, statistics, stop, names, changes, f"{scene}"
        )
        render_scene(asked)
    for path in output:
        if not is_standard_output(path):
            typer.echo(path)


def ies(
    image: Annotated[Path, typer.Argument(metavar="IMAGE.exr", help="Of an intensity meter.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE.ies|.ldt|.xml", help="Where the file goes.")
    ],
) -> None:
    """Write the image of an intensity meter as a photometric file: LM-63-2002, EULUMDAT or TM-33."""
    from nocturne_client.local.photometry import write_photometry

    write_photometry(image, output)
    typer.echo(output)


def ugr(
    file: Annotated[Path, typer.Argument(metavar="FILE.ies|.ldt", help="Photometry of a luminaire.")],
    spacing: Annotated[
        float,
        typer.Option("--spacing", min=0.1, max=2.0, help="Between luminaires, in heights above the eye."),
    ] = 0.25,
    as_json: AsJson = False,
) -> None:
    """Print a luminaire's table of unified glare ratings in standard rooms (CIE 117, CIE 190)."""
    from nocturne_client.local.ugr import ugr_rows, ugr_table

    if as_json:
        print_json(ugr_rows(file, spacing))
    else:
        CONSOLE.print(ugr_table(file, spacing))


def compile_scene(
    scene: ScenePath,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")],
    width: Width = 512,
    height: Height = 512,
    samples: Samples = 256,
) -> None:
    """Compile a scene for `nocturne-trace`: DIR/scene.pb, DIR/schedule.pb and DIR/blobs/."""
    from nocturne_client.local.compiled import compile_to

    compiled = compile_to(scene, output, width, height, samples)
    for part in compiled.dropped:
        typer.echo(f"left out: {part}", err=True)
    for line in compiled.said():
        typer.echo(line, err=True)
    typer.echo(compiled.scene_sha256)


def import_scene(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Mitsuba 3 or 0.x (.xml), pbrt-v4 or v3 (.pbrt), glTF (.gltf, .glb), Radiance (.rad), "
            "Wavefront OBJ (.obj), or a .zip of one.",
        ),
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="New folder for scene.json and its files.")
    ],
    root: Annotated[
        Path | None, typer.Option("--root", help="Folder that holds all files it names. Default: FILE's.")
    ] = None,
    parameters: Annotated[
        list[str] | None,
        typer.Option("--define", "-D", metavar="NAME=VALUE", help="A parameter of the file."),
    ] = None,
    light_radius: Annotated[
        float | None,
        typer.Option(
            "--light-radius", min=1e-9, help="Metres, of lamps that have no size. Default: by the scene."
        ),
    ] = None,
    light_degrees: Annotated[
        float,
        typer.Option("--light-degrees", min=0.01, max=180, help="Size of distant lamps that have none."),
    ] = 0.1,
    light: Annotated[
        str | None,
        typer.Option(
            "--light",
            metavar="sky|studio|FILE",
            help="Light around a scene; FILE: an HDR or EXR picture. Default: sky where nothing emits.",
        ),
    ] = None,
    time: Annotated[
        float | None, typer.Option("--time", help="Seconds into an animation. Default: everything at rest.")
    ] = None,
    allow_missing: Annotated[
        bool,
        typer.Option("--allow-missing", help="Import the rest of a scene that has unsupported parts."),
    ] = False,
) -> None:
    """Make a scene document and its files of another renderer's scene."""
    from nocturne_client.local.importing import import_to, options, report

    pairs = [each.partition("=") for each in parameters or ()]
    for name, equals, _ in pairs:
        if not equals or not name:
            raise typer.BadParameter(f"expected NAME=VALUE, found {name}", param_hint="--define")
    values = {name: value for name, _, value in pairs}
    chosen = options(root, values, light_radius, light_degrees, light, time, allow_missing)
    imported = import_to(file, output, chosen)
    for line in report(imported):
        ERRORS.print(line, markup=False, soft_wrap=True)
    typer.echo(imported.document)


def export_scene(
    scene: ScenePath,
    renderer: Annotated[
        Literal["mitsuba", "pbrt"], typer.Option("--to", help="The renderer that the scene is for.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="New folder for the scene and its files.")
    ],
    width: Width = 512,
    height: Height = 512,
    samples: Samples = 256,
    allow_missing: Annotated[
        bool,
        typer.Option("--allow-missing", help="Export the rest of a scene that has unsupported parts."),
    ] = False,
) -> None:
    """Make another renderer's scene of a scene document."""
    from nocturne_scene.film import Film

    from nocturne_client.local.exporting import export_to, report

    film = Film(width, height, samples)
    exported = export_to(scene, output, renderer, film, allow_missing=allow_missing)
    for line in report(exported):
        ERRORS.print(line, markup=False, soft_wrap=True)
    typer.echo(exported.scene)


def doctor(
    url: Annotated[
        str | None, typer.Option("--url", help="Look at this service instead of this machine.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List missing programs and packages and how to get them. Exits with 1 if a required one is missing."""
    from nocturne_client.local.doctor import examine, examine_service, table_of

    findings = examine_service(url) if url else examine()
    if as_json:
        print_json([vars(finding) for finding in findings])
    else:
        CONSOLE.print(table_of(findings))
    raise typer.Exit(int(any(finding.needed and not finding.ok for finding in findings)))


def restore(
    data: Annotated[
        Path | None, typer.Option("--data", help="Data folder to put in order. Default: yours.")
    ] = None,
    source: Annotated[
        Path | None, typer.Option("--from", metavar="DIR", help="Checkpoints. Default: those in the folder.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Examine a data folder after a disaster; replace a damaged database by the newest whole checkpoint."""
    from nocturne_client.local import restoring

    found = restoring.restore_folder(data, source)
    if as_json:
        print_json(restoring.as_json(found))
    else:
        for line in restoring.as_lines(found):
            typer.echo(line)
    raise typer.Exit(int(bool(found.missing)))


def database(
    server: Annotated[
        str,
        typer.Argument(metavar="URL", help="postgresql://USER@HOST/NAME; passwords stand in ~/.pgpass."),
    ],
    data: Annotated[
        Path | None, typer.Option("--data", help="Data folder, a new one. Default: yours.")
    ] = None,
) -> None:
    """Put the database of a new data folder on a PostgreSQL server, for services on several machines."""
    from nocturne_client.local import restoring

    folder = restoring.database_on_server(data, server)
    typer.echo(f"{folder} has its database on {server}; every program that opens the folder goes there.")
