"""Options of commands that take a scene: where it is, its film, how it is imported."""

from pathlib import Path
from typing import Annotated

import typer

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
        "--light", metavar="sky|studio|FILE", help="Of an imported scene; default: sky where nothing emits."
    ),
]
AllowMissing = Annotated[
    bool, typer.Option("--allow-missing", help="Leave out unsupported parts of an imported scene.")
]
DEFAULT_EDGE = 512
Width = Annotated[int, typer.Option("--width", help="Pixels.")]
Height = Annotated[int, typer.Option("--height", help="Pixels.")]
Samples = Annotated[int, typer.Option("--samples", help="Samples per pixel.")]
