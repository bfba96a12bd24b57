"""What a panorama's point receives: illuminances of planes and bodies, and the colour of the light.

Each is an integral of luminance times a weight over all directions (EN 12665:2018; CIE S 017:2020): of a
plane the cosine to its normal; of an upright cylinder the sine of the angle to its axis over pi; of half of
one that times (1 + cos) of the azimuth from where it faces; of a half-sphere (1 + cos) / 4 of the angle to
its base's normal; of a sphere 1 / 4. Under an even luminance L all are pi L, for each averages over the
body's surface what a plane there would get.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import directions_of
from nocturne_scene.quantities import LUMINANCE, Quantity
from nocturne_scene.spectra.temperature import ColourTemperature, colour_temperature
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import ImageMoments, read_region


@dataclass(frozen=True, slots=True)
class PointIlluminance:
    """Of one body or plane."""

    name: str
    lux: float
    error: float
    """Standard error by the pixels' own; NaN where that is not known."""


@dataclass(frozen=True, slots=True)
class PointReading:
    """All readings of a point."""

    illuminances: tuple[PointIlluminance, ...]
    modelling: float
    """Cylindrical over horizontal illuminance (EN 12464-1:2021, 4.6.3); NaN in the dark."""
    modelling_error: float
    colour: ColourTemperature | None
    """Of the light on the plane that faces the eye's direction; None in the dark."""


def _weights(azimuth: float, seen: Values) -> dict[str, Values]:
    """By name, over directions (right, up, forward); the eye looks to `azimuth`, rad, to the right."""
    right, up, forward = np.moveaxis(seen, -1, 0)
    beside = np.hypot(right, forward)
    ahead = math.sin(azimuth) * right + math.cos(azimuth) * forward
    aside = math.cos(azimuth) * right - math.sin(azimuth) * forward
    plane: Callable[[Values], Values] = lambda cosine: np.maximum(cosine, 0.0)  # noqa: E731
    return {
        "horizontal, facing up": plane(up),
        "horizontal, facing down": plane(-up),
        "vertical, ahead": plane(ahead),
        "vertical, right": plane(aside),
        "vertical, behind": plane(-ahead),
        "vertical, left": plane(-aside),
        "cylindrical": beside / math.pi,
        "semicylindrical, ahead": (beside + ahead) / math.pi,
        "hemispherical": (1.0 + up) / 4.0,
        "spherical": np.full(up.shape, 0.25),
    }


def point_reading(image: ImageMoments, quantity: Quantity, azimuth_degrees: float = 0.0) -> PointReading:
    """Of a panorama. Raises InputError for other images."""
    if quantity is not LUMINANCE:
        raise InputError.at(
            "$", f"a point's illuminances are made of luminance, and this image is of {quantity.name or 'Y'}"
        )
    height, width = image.samples.shape
    if width != 2 * height:
        raise InputError.at("$", f"{width} x {height} pixels; a panorama here is twice as wide as high")
    if not (image.samples > 0).all():
        raise InputError.at("$", "some pixels have no samples yet")
    directions = directions_of("panorama", width, height)
    reading = read_region(image)
    known = bool((image.samples > 1).all())
    factor = reading.correlation if reading and known else math.nan
    weights = {
        name: weight * directions.solid_angle
        for name, weight in _weights(math.radians(azimuth_degrees), directions.direction).items()
    }
    luminance, variance = image.mean[..., 1], image.variance[..., 1] * factor

    def of(name: str) -> PointIlluminance:
        weight = weights[name]
        spread = math.sqrt(float(np.sum(weight**2 * variance))) if known else math.nan
        return PointIlluminance(name, float(np.sum(weight * luminance)), spread)

    cylinder, level = weights["cylindrical"], weights["horizontal, facing up"]
    below = float(np.sum(level * luminance))
    modelling = float(np.sum(cylinder * luminance)) / below if below > 0.0 else math.nan
    slope = (cylinder - modelling * level) / below if below > 0.0 else np.full(level.shape, math.nan)
    modelling_error = math.sqrt(float(np.sum(slope**2 * variance))) if known and below > 0.0 else math.nan
    found = tuple(of(name) for name in weights)
    return PointReading(found, modelling, modelling_error, _colour(image, weights["vertical, ahead"], factor))


def _colour(image: ImageMoments, weight: Values, factor: float) -> ColourTemperature | None:
    """With X, Y, Z and their covariances summed over pixels."""
    xyz = np.array([float(np.sum(weight * image.mean[..., axis])) for axis in range(3)])
    if not xyz.sum() > 0.0:
        return None
    squares = weight**2 * factor
    matrix = np.diag([float(np.sum(squares * image.variance[..., axis])) for axis in range(3)])
    for index, (one, other) in enumerate(((0, 1), (0, 2), (1, 2))):
        matrix[one, other] = matrix[other, one] = float(np.sum(squares * image.covariance[..., index]))
    return colour_temperature(xyz, matrix)
