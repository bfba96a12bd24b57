"""A year of daylight as JSON, as tables and as a picture."""

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from nocturne_scene.daylight.metrics import Estimate, Share

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.annual import YearOfLight
from nocturne_client.local.annual_picture import picture
from nocturne_client.outputs import written
from nocturne_client.readings import rounded

UNITS = {
    "hours above": "h",
    "sun hours": "h",
    "mean illuminance": "lx",
    "lux hours of the year": "lx h",
    "melanopic EDI": "lx",
}
"""Of figures; all others are parts of the hours."""


def as_json(found: YearOfLight) -> dict[str, Any]:
    """All of it; `hourly` is the mean over the points of each hour of the year, lx."""
    place = found.year.place
    return {
        "weather": found.year.name,
        "latitude": place.latitude,
        "longitude": place.longitude,
        "hours": found.hours,
        "batches": found.batches,
        "samples": found.samples,
        **({} if found.blinds_closed is None else {"blinds closed": found.blinds_closed}),
        "sDA": {**_share(found.sda), "probabilities": found.sda.probabilities.tolist()},
        "ASE": _share(found.ase),
        **{name: _share(each) for name, each in found.provision.items()},
        "verdicts": [{"says": said, "probability": chance} for said, chance in found.verdicts()],
        "hourly": [float(f"{each:.4g}") for each in found.hourly.value],
        "means": {name: _estimate(each) for name, each in found.means.items()},
        "points": [
            {
                "instrument": found.points.names[i],
                "place": found.points.places[i].tolist(),
                **{
                    name: _estimate(Estimate(each.value[i], each.error[i], each.degrees))
                    for name, each in found.by_point.items()
                },
            }
            for i in range(len(found.points.names))
        ],
        "eyes": [
            {
                "instrument": found.points.names[i],
                "place": found.points.places[i].tolist(),
                **{
                    name: _estimate(Estimate(each.value[at], each.error[at], each.degrees))
                    for name, each in found.of_eyes.items()
                },
            }
            for at, i in enumerate(found.eyes)
        ],
    }


def _share(share: Share) -> dict[str, float]:
    return {"value": share.value, "low": share.low, "high": share.high}


def _estimate(each: Estimate) -> dict[str, Any]:
    low, high = each.interval()
    return {"value": float(each.value), "low": float(low), "high": float(high)}


def _json(found: YearOfLight) -> str:
    return json.dumps(as_json(found), indent=1) + "\n"


WRITERS: Mapping[str, Callable[[YearOfLight], str]] = {".json": _json, ".svg": picture}
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
