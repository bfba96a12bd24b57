"""`nocturne annual`: a year of daylight at a scene's meters, each figure with its interval."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.daylight import metrics
from nocturne_scene.daylight.coefficients import Coefficients, Layout, illuminances
from nocturne_scene.daylight.metrics import Counting, Estimate, Share
from nocturne_scene.daylight.weather_files import BadWeatherFileError, WeatherYear, read_epw
from nocturne_scene.daylight.year_of_skies import YearOfSkies, skies_of
from nocturne_scene.spectra.published import Floats

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.daylight_rounds import Points, Rounds, daylight_scene, rounds

_TOGETHER = 16
"""Points whose hours are in memory at once."""
_WORTH_LOOKING = 32
"""Samples of each batch, from which on figures are made."""

SDA_VERDICTS = (0.55, 0.75)
"""Parts of the points that LM-83 calls acceptable and preferred."""
ASE_VERDICT = 0.10
"""Part of the points that may be sunny for longer."""


@dataclass(frozen=True)
class Annual:
    """The study that is asked for."""

    scene: Path
    weather: Path
    layout: Layout
    rounds: Rounds
    north: Floats | None
    ground_reflectance: float
    """Of the ground beyond the scene."""
    hours: tuple[float, float]
    """Of the day, from and to."""
    lux: float
    sure: float
    """With which probability a verdict ends the rounds."""
    changes: Mapping[str, Any]


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

    def verdicts(self) -> list[tuple[str, float]]:
        """Statements, each with the probability that it is true."""
        said = [(f"sDA >= {part:.0%}", self.sda.at_least(part)) for part in SDA_VERDICTS]
        count = len(self.points.pixels)
        # At most a tenth sunny: one more would be too many.
        too_many = (np.floor(ASE_VERDICT * count + 1e-9) + 1) / count
        return [*said, (f"ASE <= {ASE_VERDICT:.0%}", 1.0 - self.ase.at_least(float(too_many)))]


def study(asked: Annual, told: Callable[[str], None]) -> YearOfLight:
    """Traces until each verdict about sDA is sure, or all samples are taken. Raises NocturneClientError."""
    year = read_weather(asked.weather)
    scene = daylight_scene(asked.scene, asked.changes, asked.north)
    skies = skies_of(year, asked.layout.sky, asked.ground_reflectance)
    counting = counting_of(year, skies, asked.hours, asked.lux)
    found = None
    for coefficients in rounds(scene, asked.layout, skies, asked.rounds, told):
        if coefficients.samples < min(_WORTH_LOOKING, asked.rounds.samples):
            continue
        found = measure(year, scene.points, skies, asked.layout, counting, coefficients, asked.sure)
        said = ", ".join(f"P({name}) {probability:.3f}" for name, probability in found.verdicts())
        told(f"{found.samples} samples a point: sDA {found.sda.value:.1%}; {said}")
        if found.is_sure:
            break
    assert found is not None  # noqa: S101 - the last round is one to look at
    return found


def read_weather(path: Path) -> WeatherYear:
    """Raises NocturneClientError."""
    try:
        return read_epw(path.read_text(encoding="utf-8", errors="replace"))
    except OSError as error:
        raise NocturneClientError(f"{path}: {error.strerror}") from error
    except BadWeatherFileError as error:
        raise NocturneClientError(f"{path}, {error}") from error


def counting_of(year: WeatherYear, skies: YearOfSkies, hours: Sequence[float], lux: float) -> Counting:
    """Hours of the day that count, every day of the year."""
    first, last = hours
    in_use = (year.hour > first) & (year.hour < last)
    if not in_use.any():
        raise NocturneClientError(f"no hour of the day is between {first:g} and {last:g}")
    return Counting(in_use[skies.hours], int(np.count_nonzero(in_use)), lux)


def measure(
    year: WeatherYear,
    points: Points,
    skies: YearOfSkies,
    layout: Layout,
    counting: Counting,
    coefficients: Coefficients,
    sure: float,
) -> YearOfLight:
    """The year's figures of coefficients."""
    batches = len(coefficients.sky)
    made: dict[str, list[Floats]] = {}
    by_hour = np.zeros((batches, len(skies.hours)))
    for first in range(0, coefficients.points, _TOGETHER):
        lit = illuminances(coefficients.of_points(slice(first, first + _TOGETHER)), skies, layout)
        by_hour += lit.whole.sum(axis=1)
        for name, values in metrics.replicates(lit, counting.figures()).items():
            made.setdefault(name, []).append(values)
    by_hour /= coefficients.points
    whole = {name: np.concatenate(values, axis=1) for name, values in made.items()}
    by_point = {name: metrics.jackknife(values) for name, values in whole.items()}
    means = {name: metrics.jackknife(values.mean(axis=1)) for name, values in whole.items()}
    sda = metrics.share_of_points(by_point["DA"], metrics.SDA_HOURS)
    # More hours than the limit.
    ase = metrics.share_of_points(by_point["sun hours"], metrics.ASE_HOURS + 0.5)
    hourly = Estimate(np.zeros(len(year.hour)), np.zeros(len(year.hour)), batches - 1)
    hourly.value[skies.hours] = by_hour.mean(axis=0)
    hourly.error[skies.hours] = by_hour.std(axis=0, ddof=1) / np.sqrt(batches)
    chances = [sda.at_least(part) for part in SDA_VERDICTS]
    return YearOfLight(
        year=year,
        points=points,
        batches=batches,
        samples=batches * coefficients.samples,
        hours=counting.hours,
        by_point=by_point,
        means=means,
        sda=sda,
        ase=ase,
        hourly=hourly,
        is_sure=all(each >= sure or each <= 1.0 - sure for each in chances),
    )
