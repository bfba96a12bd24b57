"""`nocturne report`."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nocturne_client.cli.measure_commands import Target, file_named
from nocturne_client.cli.output import Url
from nocturne_client.client import Client
from nocturne_client.console import CONSOLE
from nocturne_client.errors import NocturneClientError

if TYPE_CHECKING:
    from nocturne_client.contract import Glare
    from nocturne_client.scene_files import SceneOnDisk


def add_to(app: typer.Typer) -> None:
    """Adds this command to the program."""
    app.command()(report)


def report(
    target: Target,
    output: Annotated[
        list[Path],
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.pdf|.html|.json|.svg|.png",
            help="The report, its words alone, or the first plan as a picture; may be repeated.",
        ),
    ],
    scene: Annotated[
        Path | None,
        typer.Option(
            "--scene",
            metavar="SCENE.json",
            help="The scene of the image, for outlines of the room, luminaires and materials. A render of "
            "the service has its own, unless that needs files.",
        ),
    ] = None,
    require: Annotated[
        str,
        typer.Option(
            "--require",
            metavar="NAME|LIMITS",
            help="'EN 12464-1:34.2' (offices: 34.1 to 34.7), or such as Em=500,U0=0.6,UGR=19,Ra=80,DF=2.",
        ),
    ] = "",
    task: Annotated[
        str, typer.Option("--task", help="The instrument that it is for. Default: the first grid of a plane.")
    ] = "",
    glare: Annotated[
        list[str] | None,
        typer.Option(
            "--glare",
            metavar="ID|PANORAMA.exr[@AZIMUTH]",
            help="What an eye sees; may be repeated. AZIMUTH: where it looks, degrees right of the middle.",
        ),
    ] = None,
    annual: Annotated[
        Path | None, typer.Option("--annual", metavar="YEAR.json", help="Of nocturne annual -o YEAR.json.")
    ] = None,
    title: Annotated[str, typer.Option("--title", help="Default: the scene's name.")] = "",
    url: Url = None,
) -> None:
    """A report on the light of a room: plans, tables, and whether a requirement holds, with its certainty.

    The image is of the sensor `meters` or `irradiance_meter`.
    """
    from nocturne_scene.photometry.requirements import requirement

    from nocturne_client.local.failures import client_errors
    from nocturne_client.local.report import make, writing
    from nocturne_client.outputs import check_output
    from nocturne_client.scene_files import read_scene

    for path in output:
        check_output(path)
        writing.writer(path)
    with client_errors("--require"):
        wanted = requirement(require) if require else None
    glares = [_seen(each, url) for each in glare or []]
    year = make.read_annual(annual) if annual else None
    on_disk = read_scene(scene) if scene else None
    with tempfile.TemporaryDirectory(prefix="nocturne-report-") as folder:
        image = file_named(target)
        if image is None:
            image = Path(folder) / "image.exr"
            with Client(url) as client:
                client.download(target, "exr", image)
                on_disk = on_disk or _of_service(client, target, Path(folder))
        asked = make.Asked(image, target, on_disk, wanted, task, glares, year, title)
        made = make.make(asked)
    for path in output:
        writing.write(path, made)
        typer.echo(path)
    if made.verdict:
        CONSOLE.print(made.verdict, markup=False, highlight=False)


def _seen(text: str, url: str | None) -> "tuple[str, Glare]":
    """A name for people, and the rating."""
    target, _, angle = text.rpartition("@") if "@" in text else (text, "", "0")
    try:
        azimuth = float(angle)
    except ValueError as error:
        raise NocturneClientError(f"--glare {text}: expected degrees after @") from error
    file = file_named(target)
    if file is not None:
        from nocturne_client.local.measuring import glare_of_file

        found = glare_of_file(file, "panorama", 180.0, (azimuth, 0.0, None))
    else:
        with Client(url) as client:
            found = client.glare(target, azimuth, 0.0, None)
    name = Path(target).stem if file is not None else target
    return (f"{name} at {azimuth:g}°" if azimuth else name), found


def _of_service(client: Client, render: str, folder: Path) -> "SceneOnDisk | None":
    """The render's scene document; none where it needs files, which the service keeps."""
    from nocturne_client.scene_files import read_scene

    path = client.download(render, "scene", folder / "scene.json")
    try:
        return read_scene(path)
    except NocturneClientError:
        return None
