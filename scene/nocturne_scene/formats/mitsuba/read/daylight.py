"""The emitters sky, sun and sunsky of Mitsuba 0.6: east is +x, north -z, the zenith +y.

Sources: emitters/sky.cpp, sun.cpp, sunsky.cpp and sunsky/sunmodel.h. Its sky is that of L. Hosek and A.
Wilkie (2012), whose tables we don't have. Preetham's, 1.3 to 2 times brighter on level ground by itself, is
made as bright there; its red and blue on level ground are then within 20 %.
"""

import math
from datetime import datetime, timedelta

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import colours, daylight, lamps
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.spectra.published import SRGB_LUMINANCE

_DEGREES = 0.5358
"""Of the Sun's disc, before `sun_radius_scale`."""
_ROWS = 256
# lx of level ground under the sky of 0.6, whose ground has an albedo of 0.2: by its program, 2026-11-29.
_TURBIDITIES = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0)
_ZENITHS = (0.0, 20.0, 40.0, 55.0, 70.0, 80.0, 87.0)
_ILLUMINANCES = (
    (15216, 14251, 13361, 12316, 10347, 7914, 4780),
    (17031, 15779, 14760, 13628, 11260, 8439, 4936),
    (19426, 18163, 17138, 15689, 12670, 9256, 5148),
    (22752, 22027, 20903, 18894, 14864, 10455, 5391),
    (29902, 28923, 27626, 24111, 17969, 12082, 5674),
    (37422, 40631, 38629, 31569, 21292, 13482, 5768),
    (54023, 68547, 60806, 42449, 24602, 13811, 5088),
)
# cd/m2 for a value of 1 in the picture.
_UNIT = 1000.0


def add_daylight(context: Context, properties: Properties) -> Json | None:
    """Put the Sun into the scene where there is one; return the environment where there is one."""
    parts = properties.text("parts", "sunsky")
    to_world = properties.transform("to_world")
    turbidity = properties.number("turbidity", 3.0)
    stretch = properties.number("stretch", 1.0)
    scale = properties.number("scale", 1.0)
    zenith, azimuth = _sun(properties, to_world)
    if not 1 <= turbidity <= 10 or not 1 <= stretch <= 2:
        raise InputError.at(properties.place, "expected a turbidity of 1 to 10 and a stretch of 1 to 2")
    if zenith >= math.pi / 2:
        raise InputError.at(properties.place, "the Sun is below the horizon")
    sun_scale, sky_scale = (properties.number(f"{name}_scale", scale) for name in ("sun", "sky"))
    radius_scale = properties.number("sun_radius_scale", 1.0)
    extend = properties.switch("extend", False)
    properties.ignore("resolution", "albedo")
    if "sun" in parts and sun_scale > 0:
        irradiance = colours.scaled(daylight.sun_irradiance(turbidity, zenith), sun_scale)
        degrees = _DEGREES * radius_scale if radius_scale > 0 else context.options.light_degrees
        towards = to_world[:3, :3] @ _direction(zenith * stretch, azimuth)
        disc = lamps.far(towards.tolist(), degrees, irradiance)
        if radius_scale > 0:
            del disc["hidden_from"]
        context.writer.add("distant", disc)
    if "sky" not in parts or not sky_scale > 0:
        return None
    context.findings.note(
        properties.place,
        "the sky became Preetham's, as bright on level ground as that of Hosek and Wilkie",
    )
    picture = _picture(turbidity, (zenith, azimuth), stretch, extend=extend) / _UNIT
    return {
        "asset": context.writer.picture("sky", picture),
        "luminance": _UNIT * sky_scale,
        "up": to_world[:3, 1].tolist(),
        "forward": to_world[:3, 2].tolist(),
    }


def _direction(zenith: float, azimuth: float) -> Matrix:
    flat = math.sin(zenith)
    return np.array([math.sin(azimuth) * flat, math.cos(zenith), -math.cos(azimuth) * flat])


def _sun(properties: Properties, to_world: Matrix) -> tuple[float, float]:
    """Angle from the zenith and azimuth, radians."""
    said = properties.vector("sun_direction")
    latitude, longitude = properties.number("latitude", 35.6894), properties.number("longitude", 139.6917)
    place = daylight.Place(latitude, longitude, properties.number("timezone", 9.0))
    day = [properties.whole(name, value) for name, value in (("year", 2010), ("month", 7), ("day", 10))]
    hours = properties.number("hour", 15.0)
    hours += properties.number("minute", 0.0) / 60 + properties.number("second", 0.0) / 3600
    if said is not None:
        own = np.linalg.solve(to_world[:3, :3], np.array(said))
        if not np.linalg.norm(own) > 0:
            raise InputError.at(properties.place, "the direction has no length")
        x, y, z = own / np.linalg.norm(own)
        return math.acos(max(-1.0, min(1.0, y))), math.atan2(x, -z) % (2 * math.pi)
    try:
        when = datetime(day[0], day[1], day[2]) + timedelta(hours=hours)  # noqa: DTZ001 - local time
    except (ValueError, OverflowError):
        raise InputError.at(properties.place, "no such day") from None
    return daylight.solar_angles(when, place)


def _picture(turbidity: float, sun: tuple[float, float], stretch: float, *, extend: bool) -> Matrix:
    """cd/m2 of white: the first row is the zenith, the left edge north, then east."""
    rows = (np.arange(_ROWS) + 0.5) * math.pi / _ROWS
    found = _sky(turbidity, sun, rows / stretch)
    level = _sky(turbidity, sun, rows[: _ROWS // 2])
    weights = np.cos(rows) * np.sin(rows) * (math.pi / _ROWS) ** 2
    own = float(np.einsum("ijk,i,k->", level, weights[: _ROWS // 2], SRGB_LUMINANCE))
    by_turbidity = [np.interp(math.degrees(sun[0]), _ZENITHS, each) for each in _ILLUMINANCES]
    found = found * (float(np.interp(turbidity, _TURBIDITIES, by_turbidity)) / own)
    below = rows / stretch >= math.pi / 2
    if extend:
        t = np.clip(2 - 2 * rows / math.pi, 0, 1)
        return np.asarray(found * (t * t * (3 - 2 * t))[:, None, None])
    found[below] = 0.0
    return found


def _sky(turbidity: float, sun: tuple[float, float], rows: Matrix) -> Matrix:
    """cd/m2 of white of rows at these angles from the zenith."""
    around = (np.arange(2 * _ROWS) + 0.5)[None, :] * math.pi / _ROWS
    zenith = np.broadcast_to(np.minimum(rows, math.pi / 2 - 1e-3)[:, None], (len(rows), 2 * _ROWS))
    apart = np.cos(zenith) * math.cos(sun[0])
    apart = apart + np.sin(zenith) * math.sin(sun[0]) * np.cos(around - sun[1])
    return daylight.sky(turbidity, sun[0], zenith, np.arccos(np.clip(apart, -1, 1)))
