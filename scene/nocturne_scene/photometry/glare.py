"""Discomfort glare of what an eye sees: unified glare rating and daylight glare probability.

- UGR = 8 log10(0.25 / L_b * sum(L_s^2 w_s / p_s^2)): CIE 117:1995, equation 4.1. For luminaires indoors whose
  solid angles are from 0.0003 to 0.1 sr. L_b is the luminance of an even surrounding that gives as much
  illuminance at the eye as everything but the sources.
- DGP = 5.87e-5 E_v + 9.18e-2 log10(1 + sum(L_s^2 w_s / (E_v^1.87 p_s^2))) + 0.16: J. Wienold, J.
  Christoffersen, "Evaluation methods and development of a new glare prediction model for daylight
  environments with the use of CCD cameras" (Energy and Buildings 38, 2006), equation 6. For daylight, E_v of
  380 lx and more, and DGP from 0.2 to 0.8.

w_s is a source's solid angle and p_s its position index: above the line of sight S. K. Guth's as R. E. Levin
wrote it ("Position index in VCP calculations", Journal of the IES, 1975; 12 % at most from Guth's plot, of
which CIE 117 has a table), below it that of T. Iwata and M. Tokura (1997), as evalglare 1.17 has it. Sources
are connected pixels at or above a luminance.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import PixelDirections, Projection, directions_of
from nocturne_scene.quantities import LUMINANCE, Quantity
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import ImageMoments, read_region

DEFAULT_THRESHOLD = 2000.0
"""cd/m2, as in evalglare since its version 2."""

MAX_PIXELS = 2**22
"""A panorama of 2896 x 1448: a pixel is a hundredth of the smallest source that UGR is for."""

UGR_SOLID_ANGLES = (0.0003, 0.1)
DGP_MIN_ILLUMINANCE = 380.0
DGP_RANGE = (0.2, 0.8)
_MAX_POSITION_INDEX = 16.0


@dataclass(frozen=True, slots=True)
class View:
    """How an eye looks at an image."""

    azimuth_degrees: float = 0.0
    """To the right of the image's middle."""
    elevation_degrees: float = 0.0
    """Above the image's middle."""
    threshold: float = DEFAULT_THRESHOLD
    """cd/m2 from which a pixel is part of a source."""


@dataclass(frozen=True, slots=True)
class GlareSource:
    """Connected pixels that glare."""

    luminance: float
    """Mean over its solid angle, cd/m2."""
    solid_angle: float
    """sr."""
    position_index: float
    azimuth_degrees: float
    """To the right of the line of sight."""
    elevation_degrees: float
    """Above the line of sight."""


@dataclass(frozen=True, slots=True)
class Glare:
    """How much an eye is disturbed; errors are standard errors to first order, NaN where they are not
    known."""

    ugr: float
    """NaN where nothing glares: the logarithm of 0."""
    ugr_error: float
    dgp: float
    dgp_error: float
    vertical_illuminance: float
    """At the eye, lx."""
    vertical_illuminance_error: float
    background_luminance: float
    """cd/m2."""
    sources: tuple[GlareSource, ...]
    """Those that count most first."""
    notes: tuple[str, ...]
    """What is outside of the range for which a formula was made."""


def glare_of(
    image: ImageMoments, quantity: Quantity, projection: Projection, view: View, field_degrees: float = 180.0
) -> Glare:
    """Of an image of luminance all around or through a fisheye. Raises InputError for other images and
    views."""
    if quantity is not LUMINANCE:
        raise InputError.at(
            "$", f"glare is made of luminance in cd/m2, and this image is of {quantity.name or 'Y'}"
        )
    height, width = image.samples.shape
    if width * height > MAX_PIXELS:
        raise InputError.at("$", f"{width} x {height} pixels; glare is taken of {MAX_PIXELS} at most")
    if not (image.samples > 0).all():
        raise InputError.at("$", "some pixels have no samples yet")
    if not (
        view.threshold > 0.0 and abs(view.elevation_degrees) <= 90.0 and math.isfinite(view.azimuth_degrees)
    ):
        raise InputError.at("$", "expected a threshold above 0 cd/m2 and an elevation from -90 to 90 degrees")
    seen = _turned(directions_of(projection, width, height, field_degrees), view)
    reading = read_region(image)
    factor = reading.correlation if reading else 1.0
    known = bool((image.samples > 1).all())
    variance = image.variance[..., 1] * factor if known else np.full(image.samples.shape, np.nan)
    return _glare(image.mean[..., 1], variance, seen, view.threshold, projection == "panorama")


def position_index(right: Values, up: Values, forward: Values) -> Values:
    """Of directions seen by an eye, forward above 0; 1 in the line of sight, 16 at most."""
    beside = np.hypot(right, up)
    sigma = np.rad2deg(np.arctan2(beside, forward))
    tau = np.rad2deg(np.arctan2(np.abs(right), np.abs(up)))
    guth = np.exp(
        (35.2 - 0.31889 * tau - 1.22 * np.exp(-2 * tau / 9)) * 1e-3 * sigma
        + (21 + 0.26667 * tau - 0.002963 * tau**2) * 1e-5 * sigma**2
    )
    # Iwata and Tokura: by the distance from the line of sight on a plane in front of the eye.
    distance = np.minimum(beside / np.maximum(forward, 1e-9), 3.0)
    iwata = 1.0 + np.where(distance > 0.6, 1.2, 0.8) * distance
    return np.minimum(np.where(up < 0.0, iwata, guth), _MAX_POSITION_INDEX)


def _turned(seen: PixelDirections, view: View) -> PixelDirections:
    """As the eye sees them: its line of sight forward. What is behind has no solid angle."""
    azimuth, elevation = np.deg2rad([view.azimuth_degrees, view.elevation_degrees])
    right, up, forward = np.moveaxis(seen.direction, -1, 0)
    ahead = np.sin(azimuth) * right + np.cos(azimuth) * forward
    turned = np.stack(
        [
            np.cos(azimuth) * right - np.sin(azimuth) * forward,
            np.cos(elevation) * up - np.sin(elevation) * ahead,
            np.sin(elevation) * up + np.cos(elevation) * ahead,
        ],
        axis=-1,
    )
    return PixelDirections(turned, np.where(turned[..., 2] > 0.0, seen.solid_angle, 0.0))


def _glare(
    luminance: Values, variance: Values, seen: PixelDirections, threshold: float, wraps: bool
) -> Glare:
    solid_angle = seen.solid_angle
    projected = solid_angle * np.maximum(seen.direction[..., 2], 0.0)
    labels, count = _connected((luminance >= threshold) & (solid_angle > 0.0), wraps)
    background = labels == 0
    illuminance = float(np.sum(luminance * projected))
    surrounding = float(np.sum((luminance * projected)[background])) / math.pi
    sources, each_of_pixel = _sources(luminance, seen, labels, count)
    total = sum(source.luminance**2 * source.solid_angle / source.position_index**2 for source in sources)

    # How the sum changes with a source's pixel: 2 L_s w / p_s^2, as L_s is a mean over solid angle.
    slope = np.concatenate([[0.0], [2 * source.luminance / source.position_index**2 for source in sources]])
    of_sum = slope[each_of_pixel] * solid_angle
    ugr, ugr_error = math.nan, math.nan
    if total > 0.0 and surrounding > 0.0:
        ugr = 8.0 * math.log10(0.25 / surrounding * total)
        of_background = np.where(background, projected, 0.0) / math.pi
        ugr_error = _error((8.0 / math.log(10.0)) * (of_sum / total - of_background / surrounding), variance)
    dgp, dgp_error = math.nan, math.nan
    if illuminance > 0.0:
        ratio = total / illuminance**1.87
        dgp = 5.87e-5 * illuminance + 9.18e-2 * math.log10(1.0 + ratio) + 0.16
        of_ratio = of_sum / illuminance**1.87 - (1.87 * ratio / illuminance) * projected
        dgp_error = _error(
            5.87e-5 * projected + (9.18e-2 / math.log(10.0) / (1.0 + ratio)) * of_ratio, variance
        )
    found = sorted(
        sources, key=lambda source: -(source.luminance**2) * source.solid_angle / source.position_index**2
    )
    return Glare(
        ugr,
        ugr_error,
        dgp,
        dgp_error,
        illuminance,
        _error(projected, variance),
        surrounding,
        tuple(found),
        tuple(_notes(found, illuminance, dgp, seen)),
    )


def _error(slope: Values, variance: Values) -> float:
    return float(np.sqrt(np.sum(slope**2 * variance)))


def _connected(bright: NDArray[np.bool_], wraps: bool) -> tuple[NDArray[np.int64], int]:
    """Numbers of sources from 1, and how many; neighbours by edge or corner are one, across a panorama's seam
    too."""
    # Late: it takes a tenth of a second to import, and services seldom need it.
    from scipy import ndimage

    labels, count = ndimage.label(bright, structure=np.ones((3, 3)))
    labels = np.asarray(labels, dtype=np.int64)
    if wraps and count:
        names = np.arange(count + 1)
        for one, other in zip(labels[:, 0], labels[:, -1], strict=True):
            if one and other:
                names[names == names[other]] = names[one]
        kept, labels = np.unique(names[labels], return_inverse=True)
        # 0 stays what it is where anything is dark.
        labels = labels.reshape(bright.shape) + (0 if kept[0] == 0 else 1)
        count = int(labels.max())
    return labels, int(count)


def _sources(
    luminance: Values, seen: PixelDirections, labels: NDArray[np.int64], count: int
) -> tuple[list[GlareSource], NDArray[np.int64]]:
    """Each with its mean luminance and the position of its middle, weighed by luminance."""
    if count == 0:
        return [], labels

    def summed(values: Values) -> Values:
        return np.bincount(labels.ravel(), values.ravel(), count + 1)[1:].astype(np.float64)

    solid_angle = summed(seen.solid_angle)
    flux = summed(luminance * seen.solid_angle)
    middle = [summed(luminance * seen.solid_angle * seen.direction[..., axis]) / flux for axis in range(3)]
    right, up, forward = middle
    index = position_index(right, up, forward)
    length = np.sqrt(right**2 + up**2 + forward**2)
    rows = zip(
        flux / solid_angle,
        solid_angle,
        index,
        np.rad2deg(np.arctan2(right, forward)),
        np.rad2deg(np.arcsin(np.clip(up / length, -1.0, 1.0))),
        strict=True,
    )
    return [GlareSource(*map(float, row)) for row in rows], labels


def _notes(sources: list[GlareSource], illuminance: float, dgp: float, seen: PixelDirections) -> list[str]:
    notes = []
    if float(seen.solid_angle.sum()) < 0.99 * 2 * math.pi:
        notes.append(
            "the image does not hold the whole half space before the eye: E_v and both ratings are too low"
        )
    low, high = UGR_SOLID_ANGLES
    outside = sum(not low <= source.solid_angle <= high for source in sources)
    if outside:
        notes.append(f"UGR is for sources of {low:g} to {high:g} sr; {outside} of {len(sources)} are not")
    if illuminance < DGP_MIN_ILLUMINANCE:
        notes.append(
            f"DGP is for {DGP_MIN_ILLUMINANCE:g} lx at the eye and more; here are {illuminance:.4g} lx"
        )
    elif not DGP_RANGE[0] <= dgp <= DGP_RANGE[1]:
        notes.append(f"DGP is for values from {DGP_RANGE[0]:g} to {DGP_RANGE[1]:g}")
    return notes
