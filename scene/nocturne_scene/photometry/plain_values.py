"""Measurements and ratings as plain values, which the service answers and the command line finds in files."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from nocturne_scene.photometry.arriving_light import ColourValue
from nocturne_scene.photometry.measuring import (
    DaylightFactor,
    Histogram,
    Measured,
    PixelValue,
    as_csv,
    profile_as_csv,
)
from nocturne_scene.photometry.outlines import Outline
from nocturne_scene.photometry.places import Places
from nocturne_scene.photometry.polarisation import LinearPolarisation, polarisation_of

_NUMBERS = ("pixels", "zero_pixels", "mean", "mean_error", "u0", "u0_error", "ud", "ud_error")


def plain(value: Any) -> Any:
    """Dataclasses as dictionaries, sequences as lists, NaN as None."""
    if is_dataclass(value):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def plain_polarisation(found: LinearPolarisation | None) -> dict[str, Any] | None:
    """An interval that is not known is empty."""
    if found is None:
        return None
    interval = [*found.degree_interval]
    return {**plain(found), "degree_interval": [] if math.isnan(interval[0]) else interval}


@dataclass(frozen=True, slots=True)
class MeasuredOutline:
    """What one outline shows, with all that is said of it."""

    name: str
    outline: Outline
    measured: Measured
    histogram: Histogram | None = None
    colour: Sequence[ColourValue] = ()
    daylight: DaylightFactor | None = None


def plain_measurements(
    found: Sequence[MeasuredOutline],
    places: Places,
    channel: str,
    names: Sequence[str],
    of_channel: tuple[str, str],
) -> dict[str, Any]:
    """What outlines of an image show, of one of its channels; `names` are all, `of_channel` has this one's
    quantity and unit."""
    quantity, unit = of_channel

    def pixel(value: PixelValue) -> dict[str, Any]:
        return {**plain(value), "place": plain(places.place(value.x, value.y))}

    def measurement(each: MeasuredOutline) -> dict[str, Any]:
        measured = each.measured
        return {
            **{name: plain(getattr(measured, name)) for name in _NUMBERS},
            "outline": {"name": each.name, **plain(each.outline)},
            "minimum": pixel(measured.minimum),
            "maximum": pixel(measured.maximum),
            "profile": [pixel(value) for value in measured.profile],
            "profile_csv": profile_as_csv(measured, quantity, unit) if measured.profile else "",
            "histogram": each.histogram and _histogram(each.histogram),
            "colour": [
                {"name": value.name, "unit": value.unit}
                | {"value": plain(value.value), "standard_error": plain(value.error)}
                for value in each.colour
            ],
            "daylight_factor": plain(each.daylight),
            "linear_polarisation": plain_polarisation(polarisation_of(measured.reading, names, channel)),
        }

    rows = ((each.name, each.outline, each.measured) for each in found)
    return {
        "quantity": quantity,
        "unit": unit,
        "channel": channel,
        "measurements": [measurement(each) for each in found],
        "csv": as_csv(rows, quantity, unit),
    }


def _histogram(found: Histogram) -> dict[str, Any]:
    return {
        "edges": found.edges().tolist(),
        "counts": found.counts.tolist(),
        "outside": found.outside,
        "logarithmic": found.logarithmic,
    }
