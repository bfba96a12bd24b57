"""`nocturne year`: a year of daylight that a service traced."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from nocturne_client.cli.output import AsJson, Url
from nocturne_client.cli.year_options import CountedHours, EnoughLux, GroundReflectance
from nocturne_client.client import Client
from nocturne_client.console import CONSOLE
from nocturne_client.errors import NocturneClientError
from nocturne_client.outputs import check_output, written
from nocturne_client.readings import rounded

_UNITS = {
    "hours above": "h",
    "sun hours": "h",
    "mean illuminance": "lx",
    "lux hours of the year": "lx h",
    "melanopic EDI": "lx",
}
_JSON = ".json"


def add_to(app: typer.Typer) -> None:
    """Adds this command to the program."""
    app.command()(year)


def year(
    render: Annotated[
        str, typer.Argument(metavar="ID", help="A render of `nocturne submit SCENE --annual FILE.epw`.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="OUT.json", help="All figures.")
    ] = None,
    lux: EnoughLux = 300.0,
    hours: CountedHours = (8.0, 18.0),
    ground: GroundReflectance = 0.2,
    eye: Annotated[
        list[str] | None,
        typer.Option("--eye", metavar="NAME", help="An instrument at an eye: simplified DGP."),
    ] = None,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """A year of daylight at the meters of a scene whose coefficients a service has traced: the figures of
    `nocturne annual`, each with its interval, and verdicts with their probability.
    """
    if output is not None:
        if output.suffix.lower() != _JSON:
            raise NocturneClientError(f"{output}: expected a name that ends in {_JSON}")
        check_output(output)
    with Client(url) as client:
        text = client.annual(render, lux, hours, eye or (), ground)
    if output is not None:
        with written(output) as file:
            file.write(text.encode())
    if as_json:
        typer.echo(text, nl=False)
        return
    for line in _lines(json.loads(text)):
        CONSOLE.print(line, markup=False, highlight=False)


def _lines(found: Mapping[str, Any]) -> Iterator[str]:
    count = len(found["points"]) - len(found["eyes"])
    yield f"{found['weather']}: {found['hours']} hours, {count} points, 95 % intervals"
    if "blinds closed" in found:
        yield f"blinds are closed in {found['blinds closed']:.1%} of the hours"
    for name, share in (("sDA300,50%", found["sDA"]), ("ASE1000,250h", found["ASE"])):
        yield f"{name} {share['value']:.1%} ({share['low']:.1%} to {share['high']:.1%}) of the points"
    yield from (f"P({each['says']}) = {each['probability']:.3f}" for each in found["verdicts"])
    yield from (f"{name}: {_told(name, each)}" for name, each in found["means"].items())
    for eye in found["eyes"]:
        figures = {name: each for name, each in eye.items() if isinstance(each, dict)}
        yield from (f"{eye['instrument']}, {name}: {_told(name, each)}" for name, each in figures.items())


def _told(name: str, each: Mapping[str, float]) -> str:
    half = each["high"] - each["value"]
    if unit := _UNITS.get(name, ""):
        return f"{rounded(each['value'], 4)} +- {rounded(half, 2)} {unit}"
    return f"{100 * each['value']:.2f} +- {100 * half:.2f} %"
