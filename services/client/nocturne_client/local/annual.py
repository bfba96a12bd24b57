"""`nocturne annual`: a year of daylight at a scene's meters, each figure with its interval."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_scene.daylight.coefficients import Layout
from nocturne_scene.daylight.weather_files import BadWeatherFileError, WeatherYear, read_epw
from nocturne_scene.daylight.year_of_light import Traces, YearOfLight, counting_of, measure
from nocturne_scene.daylight.year_of_skies import YearOfSkies, skies_of
from nocturne_scene.errors import InputError
from nocturne_scene.spectra.published import Floats
from numpy.typing import NDArray

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.daylight_rounds import DaylightScene, Rounds, daylight_scene, rounds

_HOURS = 8760
_WORTH_LOOKING = 32
"""Samples of each batch, from which on figures are made."""


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
    blinds: Path | None = None
    """The scene with its blinds closed."""
    schedule: Path | None = None
    """In which hours they are; without, by the Sun."""
    eyes: tuple[str, ...] = ()
    """Instruments that are no part of the room's points."""
    melanopic: bool = False


def study(asked: Annual, told: Callable[[str], None]) -> YearOfLight:
    """Traces until each verdict about sDA is sure, or all samples are taken. Raises NocturneClientError."""
    try:
        return _study(asked, told)
    except InputError as error:
        raise NocturneClientError(str(error)) from error


def _study(asked: Annual, told: Callable[[str], None]) -> YearOfLight:
    year = read_weather(asked.weather)
    scene = daylight_scene(asked.scene, asked.changes, asked.north)
    skies = skies_of(year, asked.layout.sky, asked.ground_reflectance)
    counting = counting_of(year, skies, asked.hours, asked.lux)
    hours = None if asked.schedule is None else read_schedule(asked.schedule)[skies.hours]
    found = None
    for traces in _traces(asked, scene, skies, told):
        if traces.opened.samples < min(_WORTH_LOOKING, asked.rounds.samples):
            continue
        found = measure(
            year, scene.points, skies, asked.layout, counting, traces, asked.sure, hours, asked.eyes
        )
        said = ", ".join(f"P({name}) {probability:.3f}" for name, probability in found.verdicts())
        told(f"{found.samples} samples a point: sDA {found.sda.value:.1%}; {said}")
        if found.is_sure:
            break
    assert found is not None  # noqa: S101 - the last round is one to look at
    return found


def _traces(
    asked: Annual, scene: DaylightScene, skies: YearOfSkies, told: Callable[[str], None]
) -> Iterator[Traces]:
    """Rounds of the open and the closed state, and of both as melanopsin sees them."""
    scenes = [scene]
    if asked.blinds is not None:
        scenes.append(daylight_scene(asked.blinds, asked.changes, asked.north))
        if not np.array_equal(scenes[1].points.places, scene.points.places):
            raise NocturneClientError(f"{asked.blinds}: expected the same meters as in {asked.scene}")
    ways = [asked.rounds] + ([replace(asked.rounds, melanopic=True)] if asked.melanopic else [])
    runs = [rounds(each, asked.layout, skies, way, told) for way in ways for each in scenes]
    for found in zip(*runs, strict=True):
        states = [Traces(*found[at : at + len(scenes)]) for at in range(0, len(found), len(scenes))]
        yield replace(states[0], melanopic=states[1]) if asked.melanopic else states[0]


def read_schedule(path: Path) -> NDArray[np.bool_]:
    """A number for each of the 8760 hours, one a line: 1 where blinds are closed. Raises
    NocturneClientError."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split()
    except OSError as error:
        raise NocturneClientError(f"{path}: {error.strerror}") from error
    if len(lines) != _HOURS or {*lines} - {"0", "1"}:
        raise NocturneClientError(f"{path}: expected {_HOURS} lines, each 0 or 1, found {len(lines)}")
    return np.array([line == "1" for line in lines])


def read_weather(path: Path) -> WeatherYear:
    """Raises NocturneClientError."""
    try:
        return read_epw(path.read_text(encoding="utf-8", errors="replace"))
    except OSError as error:
        raise NocturneClientError(f"{path}: {error.strerror}") from error
    except BadWeatherFileError as error:
        raise NocturneClientError(f"{path}, {error}") from error
