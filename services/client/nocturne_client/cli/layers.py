"""What people want beside the image: layers."""

from typing import Annotated

import typer

LayerNames = Annotated[
    str,
    typer.Option(
        "--layers",
        metavar="NAME,...",
        help="What the EXR is to tell of surfaces: albedo, normal, depth, position, object, material or all.",
    ),
]
_ALL = ("albedo", "normal", "depth", "position", "object", "material")


def layer_names(text: str) -> tuple[str, ...]:
    """What was typed; whether there are such layers is checked where they are made."""
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    return _ALL if names == ("all",) else names
