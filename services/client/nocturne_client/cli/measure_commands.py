"""Commands that measure images: of a render of the service, or an EXR file on this machine."""

import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Column, Table

from nocturne_client.cli.output import AsJson, Url, print_json
from nocturne_client.client import Client
from nocturne_client.console import CONSOLE, ERRORS
from nocturne_client.contract import Glare, GlareSource, Measurement, Measurements, Outline
from nocturne_client.errors import NocturneClientError
from nocturne_client.readings import CONFIDENCE, interval, parse_region, polarised, rounded

Target = Annotated[
    str, typer.Argument(metavar="ID|IMAGE.exr", help="A render of the service, or a file on this machine.")
]
Colour = Annotated[
    bool,
    typer.Option(
        "--colour",
        help="Also measure the light's colour: CCT, Ra, Rf, alpha-opic; needs `colour` of the sensor.",
    ),
]
Polygon = Annotated[
    list[str] | None,
    typer.Option(
        "--polygon",
        metavar="'X,Y X,Y X,Y...'",
        help="Corners in pixels; pixels whose centres lie inside belong to it.",
    ),
]
_LEAST = {"polygon": 3, "line": 2}


def add_to(app: typer.Typer) -> None:
    """Adds these commands to the program."""
    app.command()(measure)
    app.command()(glare)
    app.command()(point)


def measure(
    target: Target,
    region: Annotated[
        list[str] | None,
        typer.Option("--region", metavar="X,Y,WIDTH,HEIGHT", help="A rectangle of pixels; may be repeated."),
    ] = None,
    polygon: Polygon = None,
    line: Annotated[
        list[str] | None,
        typer.Option("--line", metavar="X0,Y0,X1,Y1", help="From a pixel to another; gives a profile."),
    ] = None,
    channel: Annotated[
        str, typer.Option("--channel", help="X, Y, Z, or a further response of the sensor.")
    ] = "Y",
    bins: Annotated[int, typer.Option("--histogram", metavar="BINS", min=0, help="Count values, too.")] = 0,
    colour: Colour = False,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep these regions with the render, instead of the former ones.")
    ] = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Print a table for spreadsheets; of one line alone, its profile.")
    ] = False,
    meters: Annotated[
        bool,
        typer.Option("--meters", help="Print a table with a line for each meter of a file: place and value."),
    ] = False,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Minimum, mean, maximum and uniformity (U0 = min / mean, Ud = min / max) of parts of an image, with
    errors.

    Without parts, of those kept with the render; where there are none, of the sensor's instruments, or of the
    whole image.
    """
    outlines = [
        *(_rectangle(text) for text in region or []),
        *(_outline("polygon", text) for text in polygon or []),
        *(_outline("line", text) for text in line or []),
    ]
    file = file_named(target)
    if meters:
        _print_meters(target, file, channel)
        return
    if file is not None and keep:
        raise NocturneClientError("--keep: parts are kept with renders of the service, and not in files")
    if file is not None:
        from nocturne_client.local.measuring import measure_file

        found = measure_file(file, outlines, channel, bins, colour=colour)
    else:
        with Client(url) as client:
            if keep:
                client.keep_regions(target, outlines)
            found = client.measure(target, outlines, channel, bins, colour=colour)
    if as_json:
        print_json(asdict(found))
    elif as_csv:
        one = found.measurements[0].profile_csv if len(found.measurements) == 1 else ""
        typer.echo((one or found.csv).replace("\r\n", "\n"), nl=False)
    else:
        _print(found)


def _print_meters(target: str, file: Path | None, channel: str) -> None:
    from nocturne_client.local.measuring import meters_as_csv

    if file is None:
        raise NocturneClientError(f"--meters: of a file; first nocturne get {target} --exr image.exr")
    typer.echo(meters_as_csv(file, channel), nl=False)


def glare(
    target: Target,
    azimuth: Annotated[float, typer.Option("--azimuth", help="Degrees to the right of the middle.")] = 0.0,
    elevation: Annotated[float, typer.Option("--elevation", help="Degrees above the middle.")] = 0.0,
    threshold: Annotated[
        float | None,
        typer.Option(
            "--threshold",
            help="Sources are brighter, cd/m2; default: luminaires for UGR, where it has them, else 2000.",
        ),
    ] = None,
    projection: Annotated[
        str,
        typer.Option("--projection", help="Of a file: panorama, or a fisheye: equidistant, equisolid."),
    ] = "panorama",
    field: Annotated[float, typer.Option("--field", help="Of a fisheye: full angle, degrees.")] = 180.0,
    url: Url = None,
    as_json: AsJson = False,
) -> None:
    """Unified glare rating (CIE 117) and daylight glare probability of an eye that looks at a panorama."""
    file = file_named(target)
    if file is not None:
        from nocturne_client.local.measuring import glare_of_file

        found = glare_of_file(file, projection, field, (azimuth, elevation, threshold))
    else:
        with Client(url) as client:
            found = client.glare(target, azimuth, elevation, threshold)
    print_json(asdict(found)) if as_json else _print_glare(found)


def point(
    image: Annotated[Path, typer.Argument(metavar="IMAGE.exr", help="Of a panorama.")],
    azimuth: Annotated[
        float, typer.Option("--azimuth", help="Degrees to the right of the middle, where ahead is.")
    ] = 0.0,
    as_json: AsJson = False,
) -> None:
    """Illuminances at the point of a panorama: of planes, of a cylinder, half of one, a half-sphere and
    a sphere; modelling, and the light's colour temperature on the plane ahead."""
    from nocturne_client.local.measuring import point_of_file

    found = point_of_file(image, azimuth)
    if as_json:
        print_json(asdict(found))
        return
    for each in found.illuminances:
        CONSOLE.print(f"{each.name}: {_value(each.lux, each.error)} lx", highlight=False)
    CONSOLE.print(f"modelling: {_value(found.modelling, found.modelling_error, 3)}", highlight=False)
    if found.colour is not None:
        kelvin = _value(found.colour.kelvin, found.colour.kelvin_error)
        duv = f"{found.colour.duv:.4f} +- {CONFIDENCE * found.colour.duv_error:.1g}"
        CONSOLE.print(f"colour ahead: {kelvin} K, Duv {duv} (95 %)", highlight=False)


def file_named(target: str) -> Path | None:
    """A file by its ending, so that a missing one is reported as such."""
    if target.lower().endswith(".exr"):
        return Path(target)
    if Path(target).suffix and Path(target).is_file():
        raise NocturneClientError(f"{target} has no light in units and no errors; give the EXR of the image")
    return None


def _rectangle(text: str) -> Outline:
    region = parse_region(text)
    corner = [float(region.x + region.width), float(region.y + region.height)]
    return Outline("", "rectangle", [[float(region.x), float(region.y)], corner])


def _outline(kind: str, text: str) -> Outline:
    """From numbers, two for each point, whatever is between them."""
    parts = [part for part in re.split(r"[\s,;]+", text.strip()) if part]
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        numbers = []
    points = [[x, y] for x, y in zip(numbers[::2], numbers[1::2], strict=False)]
    enough = len(points) >= _LEAST[kind] and len(numbers) == 2 * len(points)
    if not enough or (kind == "line" and len(points) != _LEAST[kind]):
        expected = "X0,Y0,X1,Y1" if kind == "line" else "three corners or more, as in '0,0 64,0 64,64'"
        raise NocturneClientError(f"--{kind} {text}: expected {expected}, in pixels")
    return Outline("", "line" if kind == "line" else "polygon", points)


def _print(found: Measurements) -> None:
    numbers = [Column(name, no_wrap=True) for name in ("pixels", "min", "mean", "max", "U0", "Ud")]
    table = Table(Column("part", overflow="fold"), *numbers, box=None, pad_edge=False)
    for each in found.measurements:
        table.add_row(
            _name(each.outline),
            f"{each.pixels:,}",
            _value(each.minimum.value, each.minimum.standard_error),
            _value(each.mean, each.mean_error),
            _value(each.maximum.value, each.maximum.standard_error),
            _value(each.u0, each.u0_error, 3),
            _value(each.ud, each.ud_error, 3),
        )
    CONSOLE.print(f"{found.quantity} in {found.unit}".removesuffix(" in ") + ", with 95 % intervals")
    # Lines that are too long for the terminal go on in its next one.
    Console(highlight=False, width=max(CONSOLE.width, 100)).print(table)
    for each in found.measurements:
        _print_daylight(each)
    for each in found.measurements:
        _print_histogram(each)
        _print_colour(each)
        if each.linear_polarisation is not None:
            told = polarised(each.linear_polarisation)
            CONSOLE.print(f"{_name(each.outline)}: {told} (95 %)", highlight=False)


def _value(value: float | None, error: float | None, digits: int = 4) -> str:
    if value is None:
        return "-"
    return rounded(value, digits) + ("" if error is None else f" +- {rounded(CONFIDENCE * error, 2)}")


def _print_daylight(measured: Measurement) -> None:
    if (found := measured.daylight_factor) is not None:
        mean, least = (
            _value(found.mean, found.mean_error),
            _value(found.minimum, found.minimum_error),
        )
        CONSOLE.print(
            f"{_name(measured.outline)}: daylight factor {mean} %, least {least} %", highlight=False
        )


def _print_colour(measured: Measurement) -> None:
    if not measured.colour:
        return
    CONSOLE.print(f"\n{_name(measured.outline)}: colour of the light, with 95 % intervals")
    for each in measured.colour:
        value = _value(each.value, each.standard_error, 5)
        CONSOLE.print(f"  {each.name}: {value} {each.unit}".rstrip(), highlight=False)


def _print_histogram(measured: Measurement) -> None:
    if measured.histogram is None:
        return
    edges, counts = measured.histogram.edges, measured.histogram.counts
    most = max(1, *counts)
    CONSOLE.print(f"\n{_name(measured.outline)}")
    for low, high, count in zip(edges, edges[1:], counts, strict=False):
        CONSOLE.print(f"{low:10.4g} to {high:10.4g} {count:9,} {'#' * round(30 * count / most)}")


def _name(outline: Outline) -> str:
    points = " ".join(f"{x:g},{y:g}" for x, y in outline.points[:4])
    return outline.name or f"{outline.kind} {points}{' ...' if len(outline.points) > 4 else ''}"


def _print_glare(found: Glare) -> None:
    ugr = "not known" if found.ugr is None else interval(found.ugr, found.ugr_error, ".1f")
    dgp = "-" if found.dgp is None else interval(found.dgp, found.dgp_error, ".3f")
    illuminance = interval(found.vertical_illuminance, found.vertical_illuminance_error, ".4g")
    CONSOLE.print(f"unified glare rating {ugr}, daylight glare probability {dgp} (95 %)")
    CONSOLE.print(f"at the eye {illuminance} lx, background {found.background_luminance:.4g} cd/m2")
    if found.dgp_sources == found.sources:
        _print_sources("source", found.sources)
    else:
        _print_sources("source of UGR", found.sources)
        _print_sources("source of DGP", found.dgp_sources)
    for note in found.notes:
        ERRORS.print(f"note: {note}", markup=False, soft_wrap=True)


def _print_sources(name: str, sources: Sequence[GlareSource]) -> None:
    if not sources:
        return
    table = Table(name, "cd/m2", "sr", "position index", "azimuth", "elevation", box=None, pad_edge=False)
    for number, each in enumerate(sources, 1):
        where = f"{each.azimuth_degrees:.1f}", f"{each.elevation_degrees:.1f}"
        light = f"{each.luminance:.4g}", f"{each.solid_angle:.3g}", f"{each.position_index:.2f}"
        table.add_row(f"{number}", *light, *where)
    CONSOLE.print(table)
