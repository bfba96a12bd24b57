"""Where the Sun is, seen from a place on Earth.

I. Reda, A. Andreas, "Solar position algorithm for solar radiation applications", NREL/TP-560-34302 (revised
2008; Solar Energy 76 (2004) 577): within 0.0003 degrees for the years -2000 to 6000. Names follow its steps;
its tables are in data/spa.csv.
"""

from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache

import numpy as np

from nocturne_scene.spectra.published import Floats, data_bytes

DELTA_T = 69.2
"""Terrestrial minus universal time in 2020, s (International Earth Rotation Service). From 1985 to 2050 it is
within 25 s of this, in which the Sun moves by 0.0003 degrees among the stars."""

_J2000 = 2451545.0
_UNIX_EPOCH = 2440587.5
_FLATTENED = 0.99664719
_EARTH_RADIUS = 6378140.0


@dataclass(frozen=True)
class Place:
    """On Earth: degrees to the north and to the east, metres above the sea."""

    latitude: float
    longitude: float
    altitude: float = 0.0


@dataclass(frozen=True)
class Air:
    """What bends the Sun's light: pressure in hPa, temperature in degrees Celsius. Without pressure nothing
    does."""

    pressure: float = 1013.25
    temperature: float = 15.0

    @staticmethod
    def at(altitude: float) -> "Air":
        """Of the standard atmosphere (ISO 2533) up to 11 km."""
        kelvin = 288.15 - 0.0065 * min(max(altitude, -1000.0), 11000.0)
        return Air(1013.25 * (kelvin / 288.15) ** 5.25588, kelvin - 273.15)


@dataclass(frozen=True)
class Sun:
    """Angles in degrees, arrays of one shape: from the zenith, as seen through the air, and from north to
    east; and the distance in astronomical units."""

    zenith: Floats
    azimuth: Floats
    distance: Floats

    def towards(self) -> Floats:
        """Unit vectors to the east, to the north and up, shape (..., 3)."""
        zenith, azimuth = np.radians(self.zenith), np.radians(self.azimuth)
        across = np.sin(zenith)
        return np.stack([across * np.sin(azimuth), across * np.cos(azimuth), np.cos(zenith)], axis=-1)


def julian_day(time: datetime) -> float:
    """Of a time with a zone."""
    return time.astimezone(UTC).timestamp() / 86400 + _UNIX_EPOCH


def sun_at(julian_days: Floats, place: Place, air: Air | None = None, delta_t: float = DELTA_T) -> Sun:
    """The Sun at Julian days of universal time. `air`: by default the standard atmosphere's."""
    days = np.asarray(julian_days, dtype=np.float64)
    ephemeris_century = (days + delta_t / 86400 - _J2000) / 36525
    millennium = ephemeris_century / 10
    longitude = np.degrees(_series("L", millennium))
    latitude = np.degrees(_series("B", millennium))
    distance = _series("R", millennium)
    around, tilt_change = _nutation(ephemeris_century)
    tilt = _mean_obliquity(millennium) + tilt_change
    seen = longitude + 180 + around - 20.4898 / (3600 * distance)
    lam, beta, eps = np.radians(seen), np.radians(-latitude), np.radians(tilt)
    ascension = np.degrees(np.arctan2(np.sin(lam) * np.cos(eps) - np.tan(beta) * np.sin(eps), np.cos(lam)))
    declination = np.arcsin(np.sin(beta) * np.cos(eps) + np.cos(beta) * np.sin(eps) * np.sin(lam))
    sidereal = _sidereal_time(days) + around * np.cos(eps)
    hour_angle = np.radians(sidereal + place.longitude - ascension)
    return _from_the_ground(hour_angle, declination, distance, place, air or Air.at(place.altitude))


def _from_the_ground(hour: Floats, declination: Floats, distance: Floats, place: Place, air: Air) -> Sun:
    """Steps 3.12 to 3.15: parallax, horizon coordinates, refraction."""
    phi = np.radians(place.latitude)
    parallax = np.radians(8.794 / (3600 * distance))
    u = np.arctan(_FLATTENED * np.tan(phi))
    x = np.cos(u) + place.altitude / _EARTH_RADIUS * np.cos(phi)
    y = _FLATTENED * np.sin(u) + place.altitude / _EARTH_RADIUS * np.sin(phi)
    below = np.cos(declination) - x * np.sin(parallax) * np.cos(hour)
    shift = np.arctan2(-x * np.sin(parallax) * np.sin(hour), below)
    declination = np.arctan2((np.sin(declination) - y * np.sin(parallax)) * np.cos(shift), below)
    hour = hour - shift
    elevation = np.degrees(
        np.arcsin(np.sin(phi) * np.sin(declination) + np.cos(phi) * np.cos(declination) * np.cos(hour))
    )
    bent = np.tan(np.radians(elevation + 10.3 / (elevation + 5.11)))
    # 0.26667 is the Sun's radius, 0.5667 the refraction at the horizon: below, nothing of it is seen.
    seen = elevation >= -(0.26667 + 0.5667)
    lifted = np.where(seen, air.pressure / 1010 * 283 / (273 + air.temperature) * 1.02 / (60 * bent), 0.0)
    azimuth = np.arctan2(np.sin(hour), np.cos(hour) * np.sin(phi) - np.tan(declination) * np.cos(phi))
    return Sun(90 - elevation - lifted, (np.degrees(azimuth) + 180) % 360, distance)


def _series(name: str, millennium: Floats) -> Floats:
    """Earth's heliocentric longitude, latitude, radians, or distance, from the periodic terms."""
    total = np.zeros_like(millennium)
    for power, terms in enumerate(_periodic_terms(name)):
        a, b, c = terms.T
        total += np.sum(a * np.cos(b + c * millennium[..., None]), axis=-1) * millennium**power
    return np.asarray(total / 1e8, dtype=np.float64)


def _nutation(century: Floats) -> tuple[Floats, Floats]:
    """In longitude and in obliquity, degrees."""
    arguments = np.stack(
        [
            np.polynomial.polynomial.polyval(century, coefficients)
            for coefficients in (
                (297.85036, 445267.111480, -0.0019142, 1 / 189474),
                (357.52772, 35999.050340, -0.0001603, -1 / 300000),
                (134.96298, 477198.867398, 0.0086972, 1 / 56250),
                (93.27191, 483202.017538, -0.0036825, 1 / 327270),
                (125.04452, -1934.136261, 0.0020708, 1 / 450000),
            )
        ],
        axis=-1,
    )
    (terms,) = _periodic_terms("N")
    multiples, (a, b, c, d) = terms[:, :5], terms[:, 5:].T
    angle = np.radians(arguments @ multiples.T)
    t = century[..., None]
    in_longitude = np.sum((a + b * t) * np.sin(angle), axis=-1) / 36e6
    in_obliquity = np.sum((c + d * t) * np.cos(angle), axis=-1) / 36e6
    return in_longitude, in_obliquity


def _mean_obliquity(millennium: Floats) -> Floats:
    """Degrees."""
    seconds = (84381.448, -4680.93, -1.55, 1999.25, -51.38, -249.67, -39.05, 7.12, 27.87, 5.79, 2.45)
    return np.asarray(np.polynomial.polynomial.polyval(millennium / 10, seconds) / 3600)


def _sidereal_time(days: Floats) -> Floats:
    """The mean one at Greenwich, degrees."""
    since = days - _J2000
    century = since / 36525
    turned = 280.46061837 + 360.98564736629 * since + 0.000387933 * century**2 - century**3 / 38710000
    return np.asarray(turned % 360)


@lru_cache(maxsize=8)
def _periodic_terms(name: str) -> tuple[Floats, ...]:
    """Of one quantity, by powers of time."""
    found: dict[str, list[list[float]]] = {}
    for line in data_bytes("spa.csv").decode("ascii").splitlines():
        series, *numbers = line.split(",")
        if series.startswith(name):
            found.setdefault(series, []).append([float(number) for number in numbers])
    return tuple(np.array(found[series]) for series in sorted(found))
