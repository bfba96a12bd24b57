"""`nocturne submit`: one render, or a group of them."""

import hashlib
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from nocturne_client.cli.output import AsJson, Url, print_render
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
    parse_frames,
    parse_variants,
)
from nocturne_client.cli.stops import Cpu, Error, For, Stops, TileError, Until
from nocturne_client.cli.watching import follow
from nocturne_client.client import Client
from nocturne_client.console import ERRORS
from nocturne_client.contract import ImportedScene
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render
from nocturne_client.scene_files import SceneOnDisk, is_of_other_renderer, read_scene, with_year

Frames = Annotated[
    str,
    typer.Option(
        "--frames",
        metavar="FIRST-LAST",
        help="A render for each frame; --set PLACE=0..2.5 goes evenly from the first to the last.",
    ),
]
Varied = Annotated[
    list[str] | None,
    typer.Option("--vary", metavar="PLACE=V,...", help="A render for each value; may be repeated."),
]
InGroup = Annotated[
    str, typer.Option("--group", help="Name of the group. Default: the scene's, and a few letters.")
]
Tags = Annotated[list[str] | None, typer.Option("--tag", help="A word to sort renders by; may be repeated.")]
Wait = Annotated[
    float,
    typer.Option(
        "--wait",
        metavar="SECONDS",
        help="How long to wait, in all, while the service is busy or a quota is used up.",
    ),
]
Annual = Annotated[
    Path | None,
    typer.Option(
        "--annual",
        metavar="FILE.epw",
        help="Trace the daylight of a year at the scene's meters, by three renders; --samples are those of "
        "each point. `nocturne year ID` tells the figures.",
    ),
]
After = Annotated[str, typer.Option("--after", metavar="GROUP", help="Begin when this group has ended.")]


_PARTS = "sensor.daylight.of", ["sky", "sun_reflected", "sun_straight"]
_BATCHES = 32
"""As a scene document has them."""


def submit(
    scene: AnyScenePath,
    width: FilmWidth = None,
    height: FilmHeight = None,
    samples: Samples = 256,
    name: Annotated[str, typer.Option("--name", help="Default: the scene's own, or the file's.")] = "",
    request_id: Annotated[
        str | None,
        typer.Option("--request-id", help="Submitting again with the same id gives the same render."),
    ] = None,
    error: Error = "",
    tile_error: TileError = "",
    duration: For = "",
    cpu: Cpu = "",
    until: Until = "",
    weight: Annotated[
        int, typer.Option("--priority", help="1 to 1000; twice as much gets twice the work.")
    ] = 0,
    layers: LayerNames = "",
    bands: BandEdges = "",
    annual: Annual = None,
    sets: Settings = None,
    frames: Frames = "",
    varied: Varied = None,
    group: InGroup = "",
    after: After = "",
    tags: Tags = None,
    then_watch: Annotated[bool, typer.Option("--watch", help="Follow it to its end.")] = False,
    light: Light = "",
    allow_missing: AllowMissing = False,
    wait: Wait = 3600.0,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Upload a scene and start rendering it; prints the render's id. It ends at the first condition met.

    A folder of scene documents, --frames and --vary make a group of renders: its name is printed first.
    """
    stop = Stops(error, tile_error, duration, cpu, until).asked()
    changes, variants = changes_of(sets, bands, layers), [parse_variants(each) for each in varied or ()]
    scenes, numbers = _scenes(scene), parse_frames(frames)
    # Chosen here, so that it can be printed if the answer does not come.
    chosen = request_id or str(uuid.uuid4())
    if len(scenes) > 1 and not group:
        group = f"{scene.name} {hashlib.sha256(chosen.encode()).hexdigest()[:6]}"
    settings = {"stop": stop, "priority": weight, "layers": layer_names(layers), "changes": changes}
    settings |= {"group": group, "after": after, "tags": tags or []}
    with Client(url, patience_s=wait, on_wait=_waits) as client:
        found: dict[Path, dict[str, Any] | SceneOnDisk] = {}
        if is_of_other_renderer(scene):
            imported = _imported(client, scene, allow_missing, light)
            found[scene], name = imported.document, name or scene.stem
            width = imported.width if width is None else width
            height = imported.height if height is None else height
        if annual is not None:
            found |= {each: _year(found.get(each, each), annual) for each in scenes}
            samples, variants = _of_batch(samples, changes), [*variants, _PARTS]
        with _repeatable(chosen):
            renders = [
                render
                for number, each in enumerate(scenes)
                for render in client.submit_group(
                    found.get(each, each),
                    # 0 is refused by the service, and not taken for nothing.
                    DEFAULT_EDGE if width is None else width,
                    DEFAULT_EDGE if height is None else height,
                    samples,
                    name,
                    chosen if len(scenes) == 1 else f"{chosen}/{number}",
                    _told,
                    variants,
                    numbers,
                    each.stem if len(scenes) > 1 else "",
                    **settings,
                )
            ]
        _print(renders, as_json, whether_watched=then_watch)
        if then_watch:
            raise typer.Exit(max(follow(client.watch(render.id), as_json) for render in renders))


def _year(scene: Path | dict[str, Any] | SceneOnDisk, weather: Path) -> SceneOnDisk:
    if isinstance(scene, Path):
        on_disk = read_scene(scene)
        # Else the file's name would be lost.
        return with_year(SceneOnDisk({"name": scene.stem, **on_disk.document}, on_disk.files), weather)
    return with_year(scene if isinstance(scene, SceneOnDisk) else SceneOnDisk(scene, {}), weather)


def _of_batch(samples: int, changes: Mapping[str, Any]) -> int:
    """Samples of each batch, as `nocturne annual` has them."""
    batches = changes.get("sensor.daylight.batches", _BATCHES)
    return max(2, samples // batches) if isinstance(batches, int) and batches > 0 else samples


def _imported(client: Client, scene: Path, allow_missing: bool, light: str) -> ImportedScene:
    imported = client.import_scene(scene, allow_missing, light, _told)
    for note in (*imported.notes, *(f"missing: {each.message}" for each in imported.missing)):
        ERRORS.print(note, markup=False, soft_wrap=True)
    return imported


@contextmanager
def _repeatable(request_id: str) -> Iterator[None]:
    """Tells how to submit again, where that may help."""
    try:
        yield
    except NocturneClientError as error:
        if error.can_be_retried:
            again = f"Submit it again with --request-id {request_id}: if it was made, you get its id."
            ERRORS.print(again, markup=False, soft_wrap=True)
        raise


def _scenes(scene: Path) -> list[Path]:
    """Itself, or the documents of a folder."""
    found = sorted(scene.glob("*.json")) if scene.is_dir() else [scene]
    if not found:
        raise NocturneClientError(f"{scene} has no scene documents (*.json)")
    return found


def _waits(error: NocturneClientError, seconds: float) -> None:
    ERRORS.print(f"{error}. Asking again in {seconds:.0f} s.", markup=False, soft_wrap=True)


def _told(path: Path, sent: int, size: int) -> None:
    if sent == size:
        ERRORS.print(f"uploaded {path.name}, {size:,} bytes", markup=False)


def _print(renders: Sequence[Render], as_json: bool, *, whether_watched: bool) -> None:
    """Warnings once, the group's name, and ids; ids come after the watching where that is wanted."""
    for warning in dict.fromkeys(each.sentence for render in renders for each in render.warnings):
        ERRORS.print(f"warning: {warning}", markup=False, soft_wrap=True)
    if len(renders) > 1 and not as_json:
        typer.echo(f"group {renders[0].group}")
    for render in renders:
        if as_json and not whether_watched:
            print_render(render, as_json)
        elif not as_json:
            typer.echo(render.id)
