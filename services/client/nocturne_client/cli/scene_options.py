"""Options of commands that take a scene: its file, its film, how it is imported, further channels, and
changes of it."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from nocturne_client.errors import NocturneClientError

ScenePath = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene document, JSON.")]
AnyScenePath = Annotated[
    Path,
    typer.Argument(
        metavar="SCENE",
        help="Scene document, JSON, or a scene that is imported: .xml (Mitsuba 3), .pbrt, .gltf, .glb, .zip.",
    ),
]
FilmWidth = Annotated[
    int | None, typer.Option("--width", help="Pixels. Default: the imported file's, else 512.")
]
FilmHeight = Annotated[
    int | None, typer.Option("--height", help="Pixels. Default: the imported file's, else 512.")
]
Light = Annotated[
    str,
    typer.Option(
        "--light",
        metavar="sky|studio|FILE",
        help="Light of an imported scene; default: sky where nothing emits.",
    ),
]
AllowMissing = Annotated[
    bool, typer.Option("--allow-missing", help="Leave out unsupported parts of an imported scene.")
]
DEFAULT_EDGE = 512
Width = Annotated[int, typer.Option("--width", help="Pixels.")]
Height = Annotated[int, typer.Option("--height", help="Pixels.")]
Samples = Annotated[int, typer.Option("--samples", help="Samples per pixel.")]


LayerNames = Annotated[
    str,
    typer.Option(
        "--layers",
        metavar="NAME,...",
        help="Extra channels of surfaces in the EXR: albedo, normal, depth, position, object, material, "
        "emission or all; and of light: direct, indirect.",
    ),
]
BandEdges = Annotated[
    str,
    typer.Option(
        "--bands",
        metavar="FIRST:LAST:WIDTH",
        help="Spectral image: channels for bands of this width, nm, as spectral EXR files have them.",
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PLACE=VALUE", help="Change the scene: sensor.position[0]=1.5; may be repeated."
    ),
]
_FRAMES = re.compile(r"(\d+)-(\d+)")
_BANDS = re.compile(r"(\d+):(\d+):(\d+)")
_OF_LIGHT = ("direct", "indirect")
"""Channels of the sensor, both or none; the others are layers, which a separate pass makes."""
_ALL = ("albedo", "normal", "depth", "position", "object", "material", "emission")


def layer_names(text: str) -> tuple[str, ...]:
    """The typed names of layers of surfaces; the compiler checks them."""
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    return _ALL if names == ("all",) else tuple(name for name in names if name not in _OF_LIGHT)


def changes_of(settings: Sequence[str] | None, bands: str, layers: str) -> dict[str, Any]:
    """Changes of the document, by their places; NocturneClientError for others."""
    wants_parts = any(name.strip() in _OF_LIGHT for name in layers.split(","))
    parts = {"sensor.light_parts": True} if wants_parts else {}
    return dict(parse_change(setting) for setting in settings or ()) | parse_bands(bands) | parts


def parse_change(text: str) -> tuple[str, Any]:
    """`place=value`; a value that is no JSON is text. Raises NocturneClientError."""
    place, equals, value = text.partition("=")
    if not equals or not place.strip():
        raise NocturneClientError(f"{text!r}: expected a place and a value, such as sensor.position[0]=1.5")
    try:
        return place.strip(), json.loads(value)
    except ValueError:
        return place.strip(), value


def parse_variants(text: str) -> tuple[str, list[Any]]:
    """`place=1,2` or `place=[0,0],[1,1]`; text that is no JSON is words between commas. Raises as
    `parse_change`."""
    place, _, values = text.partition("=")
    at, _ = parse_change(text)
    try:
        return at, json.loads(f"[{values}]")
    except ValueError:
        return at, [parse_change(f"{place}={each.strip()}")[1] for each in values.split(",")]


def parse_frames(text: str) -> tuple[int, int] | None:
    """First and last of 1-240; None for an empty text. Raises NocturneClientError."""
    if not text:
        return None
    match = _FRAMES.fullmatch(text.strip())
    if match is None:
        raise NocturneClientError(f"--frames {text!r}: expected FIRST-LAST, such as 1-240")
    return int(match[1]), int(match[2])


def parse_bands(text: str) -> dict[str, Any]:
    """380:780:10 as the change of a document; raises NocturneClientError. Nothing for an empty text."""
    if not text:
        return {}
    match = _BANDS.fullmatch(text.strip())
    if match is None:
        raise NocturneClientError(f"--bands {text!r}: expected FIRST:LAST:WIDTH in nm, such as 380:780:10")
    first, last, width = (int(number) for number in match.groups())
    return {"sensor.bands": {"first": first, "last": last, "width": width}}
