"""A year of daylight as JSON, as tables and as a picture."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from nocturne_scene.daylight.metrics import Estimate
from nocturne_scene.daylight.plain_year import UNITS, as_text
from nocturne_scene.daylight.year_of_light import YearOfLight

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.annual_picture import picture
from nocturne_client.outputs import written
from nocturne_client.readings import rounded

WRITERS: Mapping[str, Callable[[YearOfLight], str]] = {".json": as_text, ".svg": picture}
"""By endings of files."""


def write(path: Path, text: str) -> None:
    """Raises NocturneClientError."""
    try:
        with written(path) as file:
            file.write(text.encode())
    except OSError as problem:
        raise NocturneClientError(f"{path}: {problem.strerror}") from problem


def points_csv(found: YearOfLight) -> str:
    """A line for each point: its figures, and half of their 95 % intervals."""
    names = [*found.by_point]
    head = ["instrument", "x", "y", "z", *(part for name in names for part in (name, f"{name} +-"))]
    rows: list[Sequence[Any]] = [head]
    halves = {name: each.interval()[1] - each.value for name, each in found.by_point.items()}
    for i, instrument in enumerate(found.points.names):
        row: list[Any] = [instrument, *(f"{each:.6g}" for each in found.points.places[i])]
        for name in names:
            row += [f"{found.by_point[name].value[i]:.6g}", f"{halves[name][i]:.3g}"]
        rows.append(row)
    return _csv(rows)


def hours_csv(found: YearOfLight) -> str:
    """A line for each hour of the year: the mean over the points, and half of its 95 % interval."""
    year = found.year
    half = found.hourly.interval()[1] - found.hourly.value
    rows: list[Sequence[Any]] = [
        ["month", "day", "hour", "direct_normal", "diffuse_horizontal", "lux", "lux +-"]
    ]
    for i in range(len(year.hour)):
        when = f"{year.month[i]:.0f}", f"{year.day[i]:.0f}", f"{year.hour[i]:g}"
        sky = f"{year.direct_normal[i]:g}", f"{year.diffuse_horizontal[i]:g}"
        rows.append([*when, *sky, f"{found.hourly.value[i]:.6g}", f"{half[i]:.3g}"])
    return _csv(rows)


def _csv(rows: Sequence[Sequence[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue()


def lines(found: YearOfLight) -> list[str]:
    """The results as lines to read."""
    said = [f"{found.year.name}: {found.hours} hours, {len(found.room)} points, 95 % intervals"]
    if found.blinds_closed is not None:
        said.append(f"blinds are closed in {found.blinds_closed:.1%} of the hours")
    shares = {"sDA300,50%": found.sda, "ASE1000,250h": found.ase, **found.provision}
    for name, share in shares.items():
        said.append(f"{name} {share.value:.1%} ({share.low:.1%} to {share.high:.1%}) of the points")
    said += [f"P({statement}) = {chance:.3f}" for statement, chance in found.verdicts()]
    said += [f"{name}: {_told(name, each)}" for name, each in found.means.items()]
    for at, i in enumerate(found.eyes):
        for name, each in found.of_eyes.items():
            one = Estimate(each.value[at], each.error[at], each.degrees)
            said.append(f"{found.points.names[i]}, {name}: {_told(name, one)}")
    return said


def _told(name: str, each: Estimate) -> str:
    half = float(each.interval()[1] - each.value)
    if unit := UNITS.get(name, ""):
        return f"{rounded(float(each.value), 4)} +- {rounded(half, 2)} {unit}"
    return f"{100 * float(each.value):.2f} +- {100 * half:.2f} %"
