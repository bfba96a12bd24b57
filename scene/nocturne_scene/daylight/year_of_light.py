"""A year of daylight at points, from coefficients: each figure with its interval."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.daylight import metrics
from nocturne_scene.daylight.coefficients import (
    Coefficients,
    Illuminances,
    Layout,
    hours_of_sun,
    illuminances,
    with_blinds,
)
from nocturne_scene.daylight.metrics import Counting, Estimate, Share
from nocturne_scene.daylight.points import Points
from nocturne_scene.daylight.weather_files import WeatherYear
from nocturne_scene.daylight.year_of_skies import YearOfSkies
from nocturne_scene.errors import InputError
from nocturne_scene.spectra.published import Floats

_TOGETHER = 16
"""Points whose hours are in memory at once."""
SDA_VERDICTS = (0.55, 0.75)
"""Parts of the points that LM-83 calls acceptable and preferred."""
ASE_VERDICT = 0.10
"""Part of the points that may be sunny for longer."""


@dataclass(frozen=True)
class Traces:
    """Coefficients by which a year is measured."""

    opened: Coefficients
    closed: Coefficients | None = None
    """Of the scene with its blinds closed."""
    melanopic: "Traces | None" = None
    """Of melanopic equivalent daylight illuminances."""

    def lit(
        self, some: slice, skies: YearOfSkies, layout: Layout, closed: NDArray[np.bool_] | None
    ) -> Illuminances:
        """Hours of some points; `closed`: in which of them blinds are."""
        found = illuminances(self.opened.of_points(some), skies, layout)
        if self.closed is None or closed is None:
            return found
        return with_blinds(found, illuminances(self.closed.of_points(some), skies, layout), closed)


@dataclass(frozen=True)
class YearOfLight:
    """The results."""

    year: WeatherYear
    points: Points
    batches: int
    samples: int
    """Of each point, all batches together."""
    hours: int
    """That count."""
    by_point: Mapping[str, Estimate]
    means: Mapping[str, Estimate]
    """Over the points."""
    sda: Share
    ase: Share
    hourly: Estimate
    """Mean over the points of each hour of the year, lx."""
    is_sure: bool
    room: NDArray[np.intp]
    """Numbers of the points that are the room's, and no eyes."""
    of_eyes: Mapping[str, Estimate]
    """Further figures, by eye."""
    eyes: NDArray[np.intp]
    provision: Mapping[str, Share]
    """By EN 17037, by name: the points with enough light in half of the daylight hours."""
    blinds_closed: float | None = None
    """Part of the hours that count; None: there are no blinds."""

    def verdicts(self) -> list[tuple[str, float]]:
        """Statements, each with the probability that it is true."""
        said = [(f"sDA >= {part:.0%}", self.sda.at_least(part)) for part in SDA_VERDICTS]
        count = len(self.room)
        # At most a tenth sunny: one more would be too many.
        too_many = (np.floor(ASE_VERDICT * count + 1e-9) + 1) / count
        said.append((f"ASE <= {ASE_VERDICT:.0%}", 1.0 - self.ase.at_least(float(too_many))))
        for name, (lux, part) in metrics.PROVISION.items():
            said.append((f"{name}: {lux:g} lx over {part:.0%}", self.provision[name].at_least(part)))
        return said


def counting_of(year: WeatherYear, skies: YearOfSkies, hours: Sequence[float], lux: float) -> Counting:
    """Hours of the day that count, every day of the year. Raises InputError."""
    first, last = hours
    in_use = (year.hour > first) & (year.hour < last)
    if not in_use.any():
        raise InputError.at("hours", f"no hour of the day is between {first:g} and {last:g}")
    return Counting(in_use[skies.hours], int(np.count_nonzero(in_use)), lux)


def measure(
    year: WeatherYear,
    points: Points,
    skies: YearOfSkies,
    layout: Layout,
    counting: Counting,
    traces: Traces,
    sure: float,
    closed: NDArray[np.bool_] | None = None,
    eyes: Sequence[str] = (),
) -> YearOfLight:
    """The year's figures of coefficients. `closed`: of the hours with light, those with closed blinds; None:
    by the Sun. `eyes`: names of instruments. Raises InputError."""
    is_eye = _are_eyes(points, eyes)
    room, of_eyes = np.flatnonzero(~is_eye), np.flatnonzero(is_eye)
    if traces.closed is not None and closed is None:
        closed = hours_of_sun(traces.opened.of_points(room), skies)
    made, hourly = _figures(traces, skies, layout, counting, closed, room)
    by_point = {name: metrics.jackknife(values) for name, values in made.items()}
    of_room = {name: each[:, room] for name, each in made.items()}
    means = {name: metrics.jackknife(values.mean(axis=1)) for name, values in of_room.items()}
    eye_names = [*counting.eye_figures(), *(counting.melanopic_figures() if traces.melanopic else {})]
    seen = {name: _of(by_point[name], of_eyes) for name in eye_names} if eyes else {}
    for name in counting.eye_figures():
        if name not in counting.figures():
            del by_point[name], means[name]
    sda = metrics.share_of_points(_of(by_point["DA"], room), metrics.SDA_HOURS)
    # More hours than the limit.
    ase = metrics.share_of_points(_of(by_point["sun hours"], room), metrics.ASE_HOURS + 0.5)
    chances = [sda.at_least(part) for part in SDA_VERDICTS]
    batches = len(traces.opened.sky)
    of_year = Estimate(np.zeros(len(year.hour)), np.zeros(len(year.hour)), batches - 1)
    of_year.value[skies.hours] = hourly.mean(axis=0)
    of_year.error[skies.hours] = hourly.std(axis=0, ddof=1) / np.sqrt(batches)
    shut = None
    if traces.closed is not None and closed is not None:
        shut = float(np.count_nonzero(closed & counting.occupied)) / counting.hours
    return YearOfLight(
        year=year,
        points=points,
        batches=batches,
        samples=batches * traces.opened.samples,
        hours=counting.hours,
        by_point=by_point,
        means=means,
        sda=sda,
        ase=ase,
        hourly=of_year,
        is_sure=all(each >= sure or each <= 1.0 - sure for each in chances),
        room=room,
        of_eyes=seen,
        eyes=of_eyes,
        provision={
            name: metrics.share_of_points(_of(by_point[name], room), metrics.PROVISION_HOURS)
            for name in metrics.PROVISION
        },
        blinds_closed=shut,
    )


def _are_eyes(points: Points, eyes: Sequence[str]) -> NDArray[np.bool_]:
    """By point. Raises InputError where an instrument is not there, or nothing but eyes is."""
    for name in eyes:
        if name not in points.names:
            known = ", ".join(dict.fromkeys(points.names))
            raise InputError.at("eye", f"no instrument has the name {name!r}; expected one of {known}")
    found = np.isin(points.names, list(eyes))
    if found.all():
        raise InputError.at("eye", "all instruments are eyes; expected points of the room, too")
    return np.asarray(found)


def _of(each: Estimate, points: NDArray[np.intp]) -> Estimate:
    return Estimate(each.value[points], each.error[points], each.degrees)


def _figures(
    traces: Traces,
    skies: YearOfSkies,
    layout: Layout,
    counting: Counting,
    closed: NDArray[np.bool_] | None,
    room: NDArray[np.intp],
) -> tuple[dict[str, Floats], Floats]:
    """Replicates of all figures by point, and the mean over the room's points by batch and hour."""
    made: dict[str, list[Floats]] = {}
    opened = traces.opened
    by_hour = np.zeros((len(opened.sky), len(skies.hours)))
    for first in range(0, opened.points, _TOGETHER):
        some = slice(first, first + _TOGETHER)
        lit = traces.lit(some, skies, layout, closed)
        by_hour += lit.whole[:, room[(room >= first) & (room < first + _TOGETHER)] - first].sum(axis=1)
        wanted = [(lit, counting.eye_figures() | counting.figures())]
        if traces.melanopic is not None:
            wanted.append((traces.melanopic.lit(some, skies, layout, closed), counting.melanopic_figures()))
        for of_light, figures in wanted:
            for name, values in metrics.replicates(of_light, figures).items():
                made.setdefault(name, []).append(values)
    return {name: np.concatenate(values, axis=1) for name, values in made.items()}, by_hour / len(room)
