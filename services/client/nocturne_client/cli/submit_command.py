"""`nocturne submit`: one render, or a group of them."""

import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from nocturne_client.cli.additions import BandEdges, LayerNames, Settings, changes_of, layer_names
from nocturne_client.cli.output import AsJson, Url, print_render
from nocturne_client.cli.scene_options import (
    DEFAULT_EDGE,
    AllowMissing,
    AnyScenePath,
    FilmHeight,
    FilmWidth,
    Light,
    Samples,
)
from nocturne_client.cli.stops import Cpu, Error, For, Stops, TileError, Until
from nocturne_client.cli.watching import follow
from nocturne_client.client import Client
from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.models import Render
from nocturne_client.scene_files import is_of_other_renderer
from nocturne_client.sequences import Member, members_of

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
After = Annotated[str, typer.Option("--after", metavar="GROUP", help="Begin when this group has ended.")]


@dataclass(frozen=True)
class _Wanted:
    """What all renders of a submission have in common."""

    film: tuple[int, int, int]
    request_id: str
    stop: Mapping[str, Any]
    priority: int
    layers: Sequence[str]
    group: str
    after: str
    tags: Sequence[str]


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
    settings: Settings = None,
    frames: Frames = "",
    varied: Varied = None,
    group: InGroup = "",
    after: After = "",
    tags: Tags = None,
    then_watch: Annotated[bool, typer.Option("--watch", help="Follow it to its end.")] = False,
    light: Light = "",
    allow_missing: AllowMissing = False,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Upload a scene and start rendering it; prints the render's id. It ends at the first condition met.

    A folder of scene documents, --frames and --vary make a group of renders: its name is printed first.
    """
    stop = Stops(error, tile_error, duration, cpu, until).asked()
    members = members_of(scene, changes_of(settings, bands, layers), frames, varied or [])
    if len(members) > 1 and not group:
        group = f"{scene.stem} {uuid.uuid4().hex[:6]}"
    with Client(url) as client:
        document: dict[str, Any] | None = None
        if is_of_other_renderer(scene):
            imported = client.import_scene(scene, allow_missing, light, _told)
            for note in (*imported.notes, *(f"missing: {each.message}" for each in imported.missing)):
                ERRORS.print(note, markup=False, soft_wrap=True)
            document, name = imported.document, name or scene.stem
            width = imported.width if width is None else width
            height = imported.height if height is None else height
        # 0 is refused by the service, and not taken for nothing.
        film = DEFAULT_EDGE if width is None else width, DEFAULT_EDGE if height is None else height, samples
        # Chosen here, so that it can be told if the answer does not come.
        chosen = request_id or str(uuid.uuid4())
        wanted = _Wanted(film, chosen, stop, weight, layer_names(layers), group, after, tags or [])
        renders = _submit_all(client, members, document, name, wanted)
        _print(renders, as_json, whether_watched=then_watch)
        if then_watch:
            raise typer.Exit(max(follow(client.watch(render.id), as_json) for render in renders))


def _submit_all(
    client: Client, members: Sequence[Member], document: dict[str, Any] | None, name: str, wanted: _Wanted
) -> list[Render]:
    try:
        return [
            client.submit(
                member.scene if document is None else document,
                *wanted.film,
                name,
                wanted.request_id if len(members) == 1 else f"{wanted.request_id}/{index}",
                _told,
                wanted.stop,
                wanted.priority,
                wanted.layers,
                member.changes,
                wanted.group,
                wanted.after,
                wanted.tags,
                member.name,
            )
            for index, member in enumerate(members)
        ]
    except NocturneClientError as error:
        if error.can_be_retried:
            again = f"Submit it again with --request-id {wanted.request_id}: if it was made, you get its id."
            ERRORS.print(again, markup=False, soft_wrap=True)
        raise


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
