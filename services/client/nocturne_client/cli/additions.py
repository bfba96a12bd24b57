"""What people want beside the image, or other than the scene has it: layers, bands, settings."""

from collections.abc import Sequence
from typing import Annotated, Any

import typer

from nocturne_client.changes import parse_bands, parse_change

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
_OF_LIGHT = ("direct", "indirect")
"""Channels of the sensor, both or none; the others are layers, which a pass of its own makes."""
_ALL = ("albedo", "normal", "depth", "position", "object", "material", "emission")


def layer_names(text: str) -> tuple[str, ...]:
    """What was typed of surfaces; whether there are such layers is checked where they are made."""
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    return _ALL if names == ("all",) else tuple(name for name in names if name not in _OF_LIGHT)


def changes_of(settings: Sequence[str] | None, bands: str, layers: str) -> dict[str, Any]:
    """Changes of the document, by their places; NocturneClientError for what can't be understood."""
    wants_parts = any(name.strip() in _OF_LIGHT for name in layers.split(","))
    parts = {"sensor.light_parts": True} if wants_parts else {}
    return dict(parse_change(setting) for setting in settings or ()) | parse_bands(bands) | parts
