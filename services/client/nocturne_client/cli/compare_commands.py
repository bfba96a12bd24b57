"""Commands that compare two images."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nocturne_client.cli.output import AsJson, Url, print_json
from nocturne_client.console import ERRORS

if TYPE_CHECKING:
    from nocturne_client.local.comparing import Compared


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    app.command(name="compare")(compare_images)
    app.command()(baseline)


def compare_images(
    image: Annotated[Path, typer.Argument(metavar="A.exr", help="The image under test, XYZ or RGB.")],
    reference: Annotated[Path, typer.Argument(metavar="B.exr", help="The reference, XYZ or RGB.")],
    variance: Annotated[
        Path | None,
        typer.Option(
            "--variance", metavar="B_var.exr", help="Variance of one sample of the reference's pixels."
        ),
    ] = None,
    reference_samples: Annotated[
        float,
        typer.Option("--reference-samples", min=1, help="Samples that B is the mean of; with --variance."),
    ] = 32_000,
    samples: Annotated[
        float | None, typer.Option("--samples", min=1, help="Samples of A's pixels. Default: as A says.")
    ] = None,
    scale: Annotated[float, typer.Option("--scale", help="A's values are multiplied by this.")] = 1.0,
    difference: Annotated[
        Path | None, typer.Option("--difference", metavar="OUT.png", help="Red: A is brighter; blue: darker.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say how far two images are apart. Exit status 1 if noise that is known does not explain it.

    Where a file does not state its errors, as other renderers' images, the means alone are judged.
    """
    from nocturne_client.local import comparing

    comparison = comparing.Comparison(image, reference, variance, reference_samples, samples, scale)
    found = comparing.compare_files(comparison, difference)
    _print_compared(found, as_json)


def _print_compared(found: "Compared", as_json: bool) -> None:
    """Ends the command."""
    from nocturne_client.local import comparing

    if as_json:
        print_json(comparing.as_json(found))
    else:
        for line in comparing.as_lines(found):
            typer.echo(line)
    raise typer.Exit(int(found.differs))


def baseline(
    render_id: Annotated[str, typer.Argument(metavar="ID", help="Of a render that has an image.")],
    engine: Annotated[
        int, typer.Option("--engine", help="Compare with this engine's. Default: the newest other one.")
    ] = 0,
    difference: Annotated[
        Path | None,
        typer.Option("--difference", metavar="OUT.png", help="Red: brighter; blue: darker."),
    ] = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Compare a render with one of the same scene and film by another engine. Exit status 1 if they differ by
    more than their noise."""
    from nocturne_client.local.comparing import compared_with_baseline

    told, found = compared_with_baseline(url, render_id, engine, difference)
    ERRORS.print(told, markup=False, soft_wrap=True)
    _print_compared(found, as_json)
