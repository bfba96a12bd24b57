"""Weather files of EnergyPlus (EPW): place, and irradiances of each hour of a year.

Fields as in "Auxiliary EnergyPlus Programs", EnergyPlus documentation: eight lines of header, then a line for
each hour, which ends at the hour that it tells.
"""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, timezone

import numpy as np

from nocturne_scene.daylight.solar_position import Place
from nocturne_scene.spectra.published import Floats

_HEADER = 8
_HOURS = (8760, 8784)
_FIELDS = 16
"""At least: up to the last one that is read."""

# Column (from 0), least and most, the value for "not known", and whether that may be.
_DEW_POINT = (7, -90.0, 60.0, 99.9)
_DIRECT = (14, 0.0, 1500.0, 9999.0)
_DIFFUSE = (15, 0.0, 1500.0, 9999.0)
_USUAL_DEW_POINT = 11.0


class BadWeatherFileError(ValueError):
    """The fault, with line and column."""


@dataclass(frozen=True)
class WeatherYear:
    """Of a place; arrays over hours."""

    name: str
    place: Place
    zone: float
    """Hours before universal time."""
    month: Floats
    day: Floats
    hour: Floats
    """In the middle of the hour, of local standard time: 0.5 is from midnight to one o'clock."""
    julian_days: Floats
    """In the middle of the hour, of universal time."""
    direct_normal: Floats
    """W/m2."""
    diffuse_horizontal: Floats
    """W/m2."""
    dew_point: Floats
    """Degrees Celsius."""


def read_epw(text: str) -> WeatherYear:
    """The year in a file. Raises BadWeatherFileError."""
    lines = text.splitlines()
    if not lines or not lines[0].upper().startswith("LOCATION,"):
        raise BadWeatherFileError("line 1: expected LOCATION, as EPW files begin")
    name, place, zone = _location(lines[0].split(","))
    rows = [(number, line.split(",")) for number, line in enumerate(lines, 1) if line.strip()][_HEADER:]
    if len(rows) not in _HOURS:
        last = rows[-1][0] if rows else len(lines)
        raise BadWeatherFileError(
            f"line {last}: {len(rows)} hours; expected {_HOURS[0]}, or {_HOURS[1]} of a leap year, one a line"
        )
    values = np.array([_hour(number, row) for number, row in rows])
    year, month, day, hour, dew, direct, diffuse = values.T
    epoch = datetime(1970, 1, 1, tzinfo=UTC)
    zone_of = timezone(timedelta(hours=zone))
    days = [
        (datetime(int(y), int(m), int(d), tzinfo=zone_of) - epoch) / timedelta(days=1)
        for y, m, d in zip(year, month, day, strict=True)
    ]
    middle = hour - 0.5
    julian = np.array(days) + middle / 24 + 2440587.5
    return WeatherYear(name, place, zone, month, day, middle, julian, direct, diffuse, dew)


def _location(fields: list[str]) -> tuple[str, Place, float]:
    if len(fields) < 10:
        raise BadWeatherFileError(f"line 1: {len(fields)} fields; expected 10")
    latitude = _number(fields[6], 1, 7, -90, 90)
    longitude = _number(fields[7], 1, 8, -180, 180)
    zone = _number(fields[8], 1, 9, -14, 14)
    altitude = _number(fields[9], 1, 10, -1000, 9000)
    name = ", ".join(part.strip() for part in fields[1:4] if part.strip(" -"))
    return name, Place(latitude, longitude, altitude), zone


def _hour(line: int, fields: list[str]) -> tuple[float, ...]:
    """Year, month, day, hour, dew point, direct normal and diffuse horizontal irradiance."""
    if len(fields) < _FIELDS:
        raise BadWeatherFileError(f"line {line}: {len(fields)} fields; expected at least {_FIELDS}")
    year = _number(fields[0], line, 1, 1900, 2100)
    month = _number(fields[1], line, 2, 1, 12)
    day = _number(fields[2], line, 3, 1, 31)
    hour = _number(fields[3], line, 4, 1, 24)
    try:
        datetime(int(year), int(month), int(day), tzinfo=UTC)
    except ValueError:
        raise BadWeatherFileError(
            f"line {line}, column 3: there is no day {day:.0f} in month {month:.0f} of {year:.0f}"
        ) from None
    dew_point = _measured(fields, line, _DEW_POINT)
    light = [_measured(fields, line, each) for each in (_DIRECT, _DIFFUSE)]
    if None in light:
        column = 1 + (_DIRECT, _DIFFUSE)[light.index(None)][0]
        raise BadWeatherFileError(f"line {line}, column {column}: the irradiance is missing")
    return (year, month, day, hour, _USUAL_DEW_POINT if dew_point is None else dew_point, *map(float, light))  # type: ignore[arg-type]


def _measured(fields: list[str], line: int, of: tuple[int, float, float, float]) -> float | None:
    column, least, most, missing = of
    try:
        if float(fields[column]) >= missing:
            return None
    except ValueError:
        pass  # told below
    return _number(fields[column], line, column + 1, least, most)


def _number(text: str, line: int, column: int, least: float, most: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not least <= value <= most:
        shown = text.strip()[:20]
        raise BadWeatherFileError(
            f"line {line}, column {column}: expected a number from {least:g} to {most:g}, found {shown!r}"
        )
    return value
