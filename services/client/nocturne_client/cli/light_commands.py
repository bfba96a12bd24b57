"""Commands about lights: mixes of light groups, a goniometer, and ray files."""

import os
import tempfile
from pathlib import Path
from typing import Annotated, Any

import typer

from nocturne_client.cli.local_commands import Threads
from nocturne_client.cli.measure_commands import Target, file_named
from nocturne_client.cli.output import Url
from nocturne_client.cli.scene_options import BandEdges, ScenePath, Settings, changes_of
from nocturne_client.cli.stops import For, Stops, share
from nocturne_client.client import Client
from nocturne_client.errors import NocturneClientError

Centre = Annotated[
    str, typer.Option("--centre", metavar="X,Y,Z", help="Centre of the sphere that holds the lamp, m.")
]
Radius = Annotated[float, typer.Option("--radius", min=0, help="Radius of that sphere, m.")]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    app.command()(mix)
    app.command()(goniometer)
    app.command()(rays)


def mix(
    target: Target,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="OUT.exr", help="Where the image goes.", dir_okay=False)
    ],
    groups: Annotated[
        list[str] | None,
        typer.Option(
            "--group",
            metavar="NAME=FACTOR",
            help="A light group, and what its light is multiplied by; may be repeated. Others keep theirs.",
        ),
    ] = None,
    url: Url = None,
) -> None:
    """Write the image with other amounts of light in its light groups, with errors; nothing is traced."""
    from nocturne_client.local.mixing import mix_file

    factors = dict(_factor(text) for text in groups or [])
    file = file_named(target)
    if file is not None:
        mix_file(file, output, factors)
    else:
        with tempfile.TemporaryDirectory(prefix="nocturne-mix-") as folder, Client(url) as client:
            mix_file(client.download(target, "exr", Path(folder) / "image.exr"), output, factors)
    typer.echo(output)


def goniometer(
    scene: ScenePath,
    output: Annotated[
        list[Path],
        typer.Option(
            "--output",
            "-o",
            metavar="LAMP.ies|.ldt|.xml",
            help="Where it goes; may be repeated.",
            dir_okay=False,
        ),
    ],
    error: Annotated[
        str,
        typer.Option(
            "--error", help='Stop when no angle\'s standard error is more than this of the largest: "1%".'
        ),
    ] = "1%",
    horizontal: Annotated[int, typer.Option("--horizontal", min=1, help="Angles C.")] = 72,
    vertical: Annotated[int, typer.Option("--vertical", min=2, help="Angles gamma.")] = 36,
    centre: Centre = "",
    radius: Radius = 0.0,
    samples: Annotated[int, typer.Option("--samples", help="Samples per angle, at most.")] = 2**16,
    duration: For = "",
    bands: BandEdges = "",
    settings: Settings = None,
    threads: Threads = 0,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Seed instead of the scene's own.")
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            "--table", metavar="LAMP.csv", help="Of errors; default: the first file's name and .csv."
        ),
    ] = None,
) -> None:
    """Measure a lamp in a scene as a goniophotometer does: a photometric file, and a table with the standard
    error of every angle.

    The scene's sensor is an intensity meter, or --centre and --radius make one. Of a ray file (IES TM-25),
    with a name in .TM25RAY instead of SCENE, the far field is written.
    """
    from nocturne_client.local.goniometer import Goniometer, measure_lamp

    changes = _meter(centre, radius) | changes_of(settings, bands, "")
    limits = Stops(duration=duration).asked() | {"angle_error": share(error, "--error")}
    where = table or output[0].with_suffix(".csv")
    threads = threads or len(os.sched_getaffinity(0))
    film = horizontal, vertical, samples
    measure_lamp(Goniometer(scene, output, where, *film, threads, seed, limits, changes))
    for path in (*output, where):
        typer.echo(path)


def rays(
    scene: ScenePath,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="LAMP.TM25RAY", help="Where it goes.", dir_okay=False),
    ],
    photons: Annotated[
        int, typer.Option("--photons", min=1, max=10_000_000, help="Photons that leave the luminaires.")
    ] = 1_000_000,
    centre: Centre = "",
    radius: Radius = 0.0,
    settings: Settings = None,
    threads: Threads = 0,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Seed instead of the scene's own.")
    ] = None,
) -> None:
    """Write what leaves a lamp in a scene as a ray file (IES TM-25): photons where they leave the sphere
    around it, each with its wavelength, W and lm.

    The scene's sensor is an intensity meter, or --centre and --radius make one. Equal scenes and seeds give
    equal bytes, whatever the threads.
    """
    from nocturne_client.local.rays import Asked, write_rays

    changes = _meter(centre, radius) | changes_of(settings, "", "")
    write_rays(Asked(scene, output, photons, threads or len(os.sched_getaffinity(0)), seed, changes))
    typer.echo(output)


def _meter(centre: str, radius: float) -> dict[str, Any]:
    """Changes of a scene that put one around its lamp; none: it has one."""
    if not (centre or radius):
        return {}
    return {"sensor": {"type": "intensity_meter", "position": _point(centre), "lamp_radius": radius}}


def _point(text: str) -> list[float]:
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != len("XYZ"):
        raise NocturneClientError(f"--centre {text}: expected X,Y,Z in metres, such as 0,2.5,0")
    return found


def _factor(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise NocturneClientError(f"--group {text}: expected NAME=FACTOR, such as windows=0.3") from None
