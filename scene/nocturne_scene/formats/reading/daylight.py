"""The Sun's place and light, and the blue sky.

Sky: A. Preetham, P. Shirley, B. Smits, "A practical analytic model for daylight", SIGGRAPH 1999, section 3
and appendix A.2. The Sun's light: the same, appendix A.1, with transmittances after M. Iqbal, "An
introduction to solar radiation", 1983. The Sun's place: M. Blanco-Muriel and others, "Computing the solar
vector", Solar Energy 70(5), 2001: within half a minute of arc.
"""

import math
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra import published, sun

Array = NDArray[np.float64]

# Rows: by quantity Y, x, y; columns: A to E as a turbidity times the first and the second.
_PEREZ = {
    "Y": ((0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)),
    "x": ((-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)),
    "y": ((-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)),
}
# Of the zenith's x and y: turbidity^2, turbidity, 1 by the Sun's angle^3, ^2, ^1, 1.
_ZENITH = {
    "x": (
        (0.00166, -0.00375, 0.00209, 0.0),
        (-0.02903, 0.06377, -0.03202, 0.00394),
        (0.11693, -0.21196, 0.06052, 0.25886),
    ),
    "y": (
        (0.00275, -0.00610, 0.00317, 0.0),
        (-0.04214, 0.08970, -0.04153, 0.00516),
        (0.15346, -0.26756, 0.06670, 0.26688),
    ),
}
# nm and absorption of ozone, 1/cm (Iqbal, table 6.3.1, some of its rows); and cm of it.
_OZONE = (
    (400, 440, 470, 500, 530, 550, 575, 600, 620, 650, 680, 700, 750, 790),
    (0.0, 0.0, 0.009, 0.030, 0.063, 0.085, 0.120, 0.125, 0.105, 0.057, 0.028, 0.018, 0.007, 0.0),
)
_OZONE_CM = 0.35

# Of the Earth's radius in astronomical units, by which the Sun stands lower than from its middle.
_PARALLAX = 6371.01 / 149597890
_DAY = 86400.0


@dataclass(frozen=True)
class Place:
    """Where and when: degrees to the north and the east, hours of local time before that of Greenwich."""

    latitude: float
    longitude: float
    timezone: float


def solar_angles(when: datetime, place: Place) -> tuple[float, float]:
    """Angle from the zenith, and azimuth from north over east, radians; `when` is local time."""
    since_2000 = (when.replace(tzinfo=UTC) - datetime(2000, 1, 1, 12, tzinfo=UTC)).total_seconds() / _DAY
    days = since_2000 - place.timezone / 24
    hours = ((days + 0.5) % 1.0) * 24
    omega = 2.1429 - 0.0010394594 * days
    mean_longitude = 4.8950630 + 0.017202791698 * days
    anomaly = 6.2400600 + 0.0172019699 * days
    longitude = mean_longitude + 0.03341607 * math.sin(anomaly) + 0.00034894 * math.sin(2 * anomaly)
    longitude += -0.0001134 - 0.0000203 * math.sin(omega)
    obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * math.cos(omega)
    ascension = math.atan2(math.cos(obliquity) * math.sin(longitude), math.cos(longitude))
    declination = math.asin(math.sin(obliquity) * math.sin(longitude))
    sidereal = 6.6974243242 + 0.0657098283 * days + hours
    hour_angle = math.radians(sidereal * 15 + place.longitude) - ascension
    north = math.radians(place.latitude)
    upright = math.cos(north) * math.cos(hour_angle) * math.cos(declination)
    zenith = math.acos(upright + math.sin(declination) * math.sin(north))
    across = math.tan(declination) * math.cos(north) - math.sin(north) * math.cos(hour_angle)
    azimuth = math.atan2(-math.sin(hour_angle), across)
    return zenith + _PARALLAX * math.sin(zenith), azimuth % (2 * math.pi)


def sky(turbidity: float, sun_zenith: float, zenith: Array, gamma: Array) -> Array:
    """Linear sRGB of directions, cd/m2 of white: by their angle from the zenith, and that from the Sun."""
    chi = (4 / 9 - turbidity / 120) * (math.pi - 2 * sun_zenith)
    top = {"Y": 1000 * ((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192)}
    for name, terms in _ZENITH.items():
        powers = np.array([sun_zenith**3, sun_zenith**2, sun_zenith, 1.0])
        top[name] = float(np.array([turbidity**2, turbidity, 1.0]) @ np.array(terms) @ powers)
    cosine = np.maximum(np.cos(zenith), 1e-3)
    found = {}
    for name, rows in _PEREZ.items():
        at = [slope * turbidity + rest for slope, rest in rows]
        over = _perez(at, 1.0, math.cos(sun_zenith), sun_zenith)
        found[name] = top[name] * _perez(at, cosine, np.cos(gamma), gamma) / over
    luminance, x, y = np.maximum(found["Y"], 0.0), found["x"], found["y"]
    xyz = np.stack([x / y * luminance, luminance, (1 - x - y) / y * luminance], axis=-1)
    return np.asarray(np.maximum(xyz @ published.XYZ_TO_SRGB.T, 0.0))


def _perez(at: list[float], cosine: Array | float, cos_gamma: Array | float, gamma: Array | float) -> Array:
    a, b, c, d, e = at
    return np.asarray((1 + a * np.exp(b / cosine)) * (1 + c * np.exp(d * gamma) + e * cos_gamma**2))


def sun_irradiance(turbidity: float, zenith: float) -> Json:
    """Of a surface that faces the Sun, W m-2 nm-1, as a table."""
    nm = published.visible_wavelengths()
    um = nm / 1000
    mass = 1 / (math.cos(zenith) + 0.15 * max(93.885 - math.degrees(zenith), 0.1) ** -1.253)
    beta = max(0.0, 0.04608365822050 * turbidity - 0.04586025928522)
    depth = 0.008735 * um**-4.08 + beta * um**-1.3 + _OZONE_CM * np.interp(nm, *_OZONE)
    values = sun.irradiance() * np.exp(-mass * depth)
    return {"table": np.stack([nm, values], 1)[::5].tolist()}
