"""When a render ends, besides at its last sample: errors, times, and the samples of each tile. Pure.

A tile's own error decides from the tile's own sums, at the ends of ranges only, so it gives the same bits for
any workers in any order. What a clock or the whole image's error decides does not; such an image says in its
manifest how many samples each tile has, and a render that asks for exactly those gives the same bits.
"""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from datetime import date, datetime, time, timedelta, tzinfo
from functools import lru_cache
from typing import Any, Self
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from nocturne.v1 import job_pb2
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.ranges import TileGrid, entries_of

from nocturne_coordinator import limits

_CLOCK = re.compile(r"(\d{1,2}):(\d{2})(?::(\d{2}))?\s*(\S+)")
_EXAMPLES = 'as in "07:00 Europe/Berlin", "07:00+01:00" or "2026-11-22T07:00:00Z"'


@dataclass(frozen=True, slots=True)
class StopConditions:
    """Stop conditions; a render ends at the first that is met. 0 or empty: not asked for."""

    relative_error: float = 0.0
    """Of the image, as in Progress, where it is to be trusted: see trust."""
    tile_relative_error: float = 0.0
    """Of each tile, from its own pixels, likewise; a tile that has it gets no more samples."""
    wall_seconds: float = 0.0
    """Of running, pauses left out."""
    cpu_seconds: float = 0.0
    """Of workers' processors, in merged ranges."""
    until: float = 0.0
    """Unix time."""
    until_text: str = ""
    """The same as it was given."""
    tile_samples: tuple[int, ...] = ()
    """Samples of each tile, all of them ends of planned ranges: the manifest of an image."""

    def to_json(self) -> str:
        """All conditions on one line, without those that were not asked for."""
        return json.dumps(self.asked(), separators=(",", ":"))

    def asked(self) -> dict[str, Any]:
        """The conditions that were asked for, by name."""
        return {name: value for name, value in asdict(self).items() if value}

    @classmethod
    @lru_cache(maxsize=64)
    def from_json(cls, text: str) -> Self:
        """What `to_json` gave. Most of thousands of renders have the same."""
        values = json.loads(text)
        values["tile_samples"] = tuple(values.get("tile_samples", ()))
        return cls(**values)

    def request(self) -> dict[str, Any]:
        """The identity of a request: the time as it was given, not the value computed from it."""
        asked = self.asked()
        if self.until_text:
            asked.pop("until", None)
        return asked


EVERYTHING = StopConditions()
"""All samples, however long it takes."""


def changed_conditions(
    before: StopConditions, asked: Mapping[str, Any], drop: Sequence[str], now: datetime
) -> StopConditions:
    """The conditions before, with those that are asked for changed and those in `drop` left out.

    A time in the same words as before is the same time. Raises InputError with all problems.
    """
    known = {field.name for field in fields(StopConditions)} - {"until_text", "tile_samples"}
    problems = [
        Problem(f"$.drop[{index}]", f"{name} is no condition; expected {', '.join(sorted(known))}")
        for index, name in enumerate(drop)
        if name not in known
    ]
    for name, value in asked.items():
        if name in drop:
            problems.append(Problem(f"$.stop.{name}", "is changed and dropped at once"))
        elif name in known and not value:
            message = f"is {value!r}, which asks for nothing; name it in `drop` to go on without it"
            problems.append(Problem(f"$.stop.{name}", message))
    if problems:
        raise InputError(problems)
    others = {name: value for name, value in asked.items() if (name, value) != ("until", before.until_text)}
    changes = stop_conditions(others, now).asked()
    dropped: dict[str, Any] = dict.fromkeys(drop, 0.0)
    if "until" in drop:
        dropped["until_text"] = ""
    return replace(before, **{**dropped, **changes})


def ends_at_once(stop: StopConditions, unix_time: float, ran_seconds: float, cpu_seconds: float) -> str:
    """Which condition is met before anything more is traced, as a sentence; empty: none."""
    if stop.until and unix_time >= stop.until:
        return f"until {stop.until_text} is over"
    if stop.wall_seconds and ran_seconds >= stop.wall_seconds:
        return f"wall_seconds: it has run for {ran_seconds:.0f} of {stop.wall_seconds:g} s"
    if stop.cpu_seconds and cpu_seconds >= stop.cpu_seconds:
        return f"cpu_seconds: it has used {cpu_seconds:.0f} of {stop.cpu_seconds:g} s"
    return ""


def stop_conditions(asked: Mapping[str, Any], now: datetime) -> StopConditions:
    """Checks what a caller asks for: numbers by field name, `until` a text (see `parse_until`).

    Raises InputError with all problems, at `$.stop.NAME`.
    """
    known = {field.name for field in fields(StopConditions)} - {"until_text", "tile_samples"}
    problems = [
        Problem(f"$.stop.{name}", f"is not known; expected {', '.join(sorted(known))}")
        for name in asked
        if name not in known
    ]
    for name, most in _NUMBERS.items():
        value = asked.get(name, 0.0)
        if not isinstance(value, int | float) or not (math.isfinite(value) and 0.0 <= value <= most):
            problems.append(Problem(f"$.stop.{name}", f"expected a number above 0, at most {most:g}"))
    text, until = asked.get("until", "") or "", 0.0
    if text:
        try:
            until = parse_until(text, now)
        except ValueError as error:
            problems.append(Problem("$.stop.until", str(error)))
    if problems:
        raise InputError(problems)
    numbers: dict[str, Any] = {name: float(asked.get(name, 0.0)) for name in _NUMBERS}
    return StopConditions(**numbers, until=until, until_text=text)


_NUMBERS = {
    "relative_error": limits.MAX_ERROR_ASKED,
    "tile_relative_error": limits.MAX_ERROR_ASKED,
    "wall_seconds": limits.MAX_SECONDS_ASKED,
    "cpu_seconds": limits.MAX_SECONDS_ASKED,
}


def parse_until(text: str, now: datetime) -> float:
    """The unix time of a date and time, or of the next time that a clock shows; both with their zone.

    `now` must have a zone. ValueError, fit to be shown, for all else and for times that are over.
    """
    if not isinstance(text, str) or len(text) > limits.MAX_NAME:
        raise ValueError(f"expected a time with its zone, {_EXAMPLES}")
    clock = _CLOCK.fullmatch(text.strip())
    moment = _next_time(clock, now) if clock else _moment(text.strip())
    if moment <= now:
        raise ValueError(f"{text} is over")
    if moment > now + timedelta(seconds=limits.MAX_SECONDS_ASKED):
        raise ValueError(f"{text} is more than {limits.MAX_SECONDS_ASKED / 86400:g} days ahead")
    return moment.timestamp()


def _moment(text: str) -> datetime:
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"expected a time with its zone, {_EXAMPLES}") from None
    if moment.tzinfo is None:
        raise ValueError(f"{text} has no zone; expected {_EXAMPLES}")
    return moment


def _next_time(clock: re.Match[str], now: datetime) -> datetime:
    hour, minute, second, zone = clock.groups()
    try:
        shown = time(int(hour), int(minute), int(second or 0))
    except ValueError:
        raise ValueError(f"there is no {clock[0]}; expected 00:00 to 23:59") from None
    zone_info = _zone(zone)
    today: date = now.astimezone(zone_info).date()
    for days in range(3):
        # Wall clock arithmetic: the day of a change to summer time has 23 hours.
        moment = datetime.combine(today + timedelta(days=days), shown, zone_info)
        if moment > now:
            return moment
    raise ValueError(f"{clock[0]} does not come")


def _zone(name: str) -> tzinfo:
    if re.fullmatch(r"[+-]\d{2}:?\d{2}|Z", name):
        zone = datetime.fromisoformat(f"2000-01-01T00:00:00{name}").tzinfo
        assert zone is not None  # noqa: S101 - the text has one
        return zone
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise ValueError(f"{name} is no time zone; expected {_EXAMPLES}") from None


def check_tile_samples(samples: Sequence[int], schedule: job_pb2.RangeSchedule) -> None:
    """Raises InputError unless each tile has a number of samples that is 0 or the end of a planned range, and
    forward photons, last, likewise."""
    tiles, entries = TileGrid.of(schedule).count, entries_of(schedule)
    if len(samples) != entries:
        raise InputError.at("$.stop.tile_samples", f"{len(samples)} numbers for {entries} tiles")
    ends, photons = {0, *schedule.range_ends}, {0, *schedule.photon_range_ends}
    wrong = next(
        (index for index, end in enumerate(samples) if end not in (ends if index < tiles else photons)), None
    )
    if wrong is not None:
        raise InputError.at(
            f"$.stop.tile_samples[{wrong}]", f"{samples[wrong]} samples are not the end of a planned range"
        )
