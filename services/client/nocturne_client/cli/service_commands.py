"""Commands that talk to a service."""

import sys
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nocturne_client.cli.output import (
    AsJson,
    Url,
    group_sentence,
    print_json,
    print_render,
    print_renders,
    print_usage,
    print_workers,
)
from nocturne_client.cli.stops import Cpu, Drop, Error, For, Stops, TileError, Until, dropped
from nocturne_client.cli.submit_command import submit
from nocturne_client.cli.top import show_top
from nocturne_client.cli.watching import about, follow, graphics_wanted
from nocturne_client.client import Client, ImageKind
from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.outputs import check_output
from nocturne_client.readings import parse_region, sentence

if TYPE_CHECKING:
    from nocturne_client.preview.sinks import Sink


def _known_ids(incomplete: str) -> list[tuple[str, str]]:
    """Ids of the newest renders for the shell to choose from; none where no service answers."""
    try:
        with Client() as client:
            renders = client.list()
    except NocturneClientError:
        return []
    return [(each.id, f"{each.name}, {each.state}") for each in renders if each.id.startswith(incomplete)]


RenderId = Annotated[
    str,
    typer.Argument(
        metavar="ID",
        help="Id of a render, as printed by submit and list, or its first characters.",
        autocompletion=_known_ids,
    ),
]


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    app.command(name="list")(list_renders)
    changes = (cancel, delete, pause, resume, extend, priority, tag, replay)
    for command in (submit, watch, top, get, group, *changes, explain, workers, usage):
        app.command()(command)


def watch(
    render_id: RenderId,
    image: Annotated[
        str,
        typer.Option("--image", help="auto, none, kitty, iterm2 or sixel: what this terminal knows."),
    ] = "auto",
    tev: Annotated[
        str, typer.Option("--tev", metavar="HOST[:PORT]", help="Send changed tiles to a running tev viewer.")
    ] = "",
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Follow a render to its end, with its picture in terminals that can show one."""
    with Client(url) as client, ExitStack() as open_sinks:
        sinks: list[Sink] = []
        if tev:
            from nocturne_client.preview.sinks import TevSink
            from nocturne_client.preview.tev import Tev

            sinks.append(TevSink(client, open_sinks.enter_context(Tev(tev))))
        graphics = graphics_wanted(image, sys.stderr.isatty() and not as_json)
        if graphics is not None:
            from nocturne_client.preview.sinks import TerminalSink

            sinks.append(TerminalSink(client, graphics, sys.stderr.buffer, about))
        raise typer.Exit(follow(client.watch(render_id), as_json, sinks))


def list_renders(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            help="Words that all stand in name, id, owner, state, group or tags. Default: all renders."
        ),
    ] = None,
    limit: Annotated[int, typer.Option("--limit", min=1, help="How many at most.")] = 20,
    only_tag: Annotated[str, typer.Option("--tag", help="With this tag only.")] = "",
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """List renders, newest first."""
    with Client(url) as client:
        print_renders([*client.list(limit, tag=only_tag, search=" ".join(words or []))], as_json)


def top(
    once: Annotated[bool, typer.Option("--once", help="Print it once instead of following it.")] = False,
    url: Url = None,
) -> None:
    """Follow all open renders and all workers in this terminal; Ctrl-C ends it."""
    with Client(url) as client:
        show_top(client, once)


def get(
    render_id: RenderId,
    exr: Annotated[
        Path | None, typer.Option("--exr", help="Write the image here: XYZ, error, counts.")
    ] = None,
    png: Annotated[Path | None, typer.Option("--png", help="Write the preview here.")] = None,
    scene: Annotated[
        Path | None, typer.Option("--scene", help="Write the scene document here, as it was submitted.")
    ] = None,
    denoised: Annotated[
        Path | None,
        typer.Option("--denoised", help="Write a denoised picture here, .png or .exr: to look at only."),
    ] = None,
    difference: Annotated[
        Path | None,
        typer.Option("--difference", help="Write a PNG of where the denoised picture leaves the error bars."),
    ] = None,
    log: Annotated[Path | None, typer.Option("--log", help="Write its history here, line by line.")] = None,
    bundle: Annotated[
        Path | None,
        typer.Option("--bundle", help="Write a ZIP for a bug report here."),
    ] = None,
    region: Annotated[
        str,
        typer.Option(
            "--region",
            metavar="X,Y[,WIDTH,HEIGHT]",
            help="Print these pixels instead: value, 95 % interval, unit.",
        ),
    ] = "",
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Show a render, and fetch its images as they are now."""
    with Client(url) as client:
        render = client.get(render_id)
        if region:
            reading = client.read_region(render.id, parse_region(region))
            print_json(asdict(reading)) if as_json else typer.echo(sentence(reading))
            return
        as_png = denoised is not None and denoised.suffix.lower() == ".png"
        files: dict[ImageKind, Path | None] = {
            "exr": exr,
            "png": png,
            "scene": scene,
            "denoised_png" if as_png else "denoised_exr": denoised,
            "difference": difference,
            "log": log,
            "bundle": bundle,
        }
        for kind, path in files.items():
            if path is not None:
                client.download(render_id, kind, path)
        price = None if as_json else client.usage()
    print_render(render, as_json, price)


def group(
    name: Annotated[str, typer.Argument(metavar="GROUP", help="As submit printed it.")],
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Show how far the renders of a group are, together and each."""
    with Client(url) as client:
        found = client.group(name)
        if as_json:
            print_json(asdict(found))
            return
        typer.echo(group_sentence(found))
        print_renders([*client.list(found.renders, group=name)], as_json)


def cancel(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Stop a render; its merged samples stay and can be fetched."""
    with Client(url) as client:
        print_render(client.cancel(render_id), as_json)


def delete(
    render_id: RenderId,
    yes: Annotated[bool, typer.Option("--yes", help="Cancel it without asking if it has not ended.")] = False,
    url: Url = None,
) -> None:
    """Delete a render, its images and the files that no other render uses; a running one is cancelled."""
    with Client(url) as client:
        render = client.get(render_id)
        if not render.has_ended:
            about = f"{render.id} ({render.name}) is {render.state}, {render.fraction:.0%} done."
            if not yes:
                typer.confirm(f"{about} Cancel and delete it?", abort=True, err=True)
            client.cancel(render.id)
        # By its whole id: a prefix that was unique may be the beginning of another's id when the render is
        # gone.
        client.delete(render.id)


def pause(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Pause a render until it is resumed; its merged samples stay."""
    with Client(url) as client:
        print_render(client.pause(render_id), as_json)


def resume(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Go on with a paused render; with a degraded one, by tracing its failed tiles again."""
    with Client(url) as client:
        print_render(client.resume(render_id), as_json)


def extend(
    render_id: RenderId,
    samples: Annotated[int, typer.Option("--samples", help="In all; 0: as many as before.")] = 0,
    error: Error = "",
    tile_error: TileError = "",
    duration: For = "",
    cpu: Cpu = "",
    until: Until = "",
    drop: Drop = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Give a render more samples, or other conditions, also after its end; all others stay.

    Nothing is traced again.
    """
    stop, names = Stops(error, tile_error, duration, cpu, until).asked(), dropped(drop or [])
    with Client(url) as client:
        before = client.get(render_id).stop
        for option, name in names.items():
            had = getattr(before, name)
            ERRORS.print(f"without --{option} from here on; it was {had}" if had else f"it had no --{option}")
        print_render(client.extend(render_id, samples, stop, [*names.values()]), as_json)


def priority(
    render_id: RenderId,
    weight: Annotated[int, typer.Argument(metavar="N", help="1 to 1000; 100 is usual.")],
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Change a render's share of the workers among the renders of its owner."""
    with Client(url) as client:
        print_render(client.set_priority(render_id, weight), as_json)


def replay(
    render_id: RenderId,
    exr: Annotated[Path | None, typer.Option("--exr", help="Wait for it, and write the image here.")] = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Trace a render once more with the samples that each of its tiles has: the image has the same bits."""
    if exr is not None:
        check_output(exr)
    with Client(url) as client:
        again = client.replay(render_id)
        if exr is None:
            print_render(again, as_json) if as_json else typer.echo(again.id)
            return
        status = follow(client.watch(again.id), as_json)
        client.download(again.id, "exr", exr)
        raise typer.Exit(status)


def tag(
    render_id: RenderId,
    tags: Annotated[
        list[str] | None, typer.Argument(help="Tags instead of the former ones; none: no tags.")
    ] = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Give a render tags, words to sort renders by."""
    with Client(url) as client:
        print_render(client.set_tags(render_id, tags or []), as_json)


def usage(url: Url = None, as_json: AsJson = False) -> None:
    """Show each owner's share of the workers, and its cost so far."""
    with Client(url) as client:
        found = client.usage()
    print_json(asdict(found)) if as_json else print_usage(found)


def explain(render_id: RenderId, url: Url = None, as_json: AsJson = False) -> None:
    """Say in one sentence what a render waits for."""
    with Client(url) as client:
        sentence = client.explain(render_id)
    print_json({"sentence": sentence}) if as_json else typer.echo(sentence)


def workers(
    drain: Annotated[
        str,
        typer.Option("--drain", metavar="WORKER", help="Give this worker no more jobs; it finishes its own."),
    ] = "",
    release: Annotated[
        str,
        typer.Option("--release", metavar="WORKER", help="Give this one jobs again, and take its results."),
    ] = "",
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """List workers, and why any of them is idle."""
    with Client(url) as client:
        if drain:
            client.drain_worker(drain)
        if release:
            client.release_worker(release)
        print_workers([*client.workers()], as_json)
