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
which CIE 117 has a table), below it that of T. Iwata and M. Tokura (1997), as evalglare 1.17 has it.

UGR's sources are the luminaires, wherever an image tells them by the layer `emission`: connected pixels
in which any emits towards the eye. DGP's, and UGR's of other images, are connected pixels at or above a
luminance.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import PixelDirections, Projection, directions_of
from nocturne_scene.photometry.glare_sources import GlareSource, Glaring, brighter_than, of_luminaires
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
_MOST_INDEX = 16.0
"""Position index in DGP, as in evalglare."""
TABLE_ENDS = (3.0, 1.9)
"""Where CIE 117's table of position indices ends: distances to the side and up, over that along the line of
sight. It leaves out luminaires beyond; the formula goes on, and counts them the less the farther they are."""

_FEWEST_PIXELS, _ERROR_OF_FEWEST = 9, 0.2
"""Of a luminaire, from 16 samples of each pixel, and by how much the UGR of it alone is wrong at most, for
95 % of squares and strips drawn in any place and direction; with 4 pixels it is 0.3, with 2 0.5."""
_FEWEST_WHOLE_PIXELS, _ERROR_OF_FEWEST_WHOLE = 100, 0.7
"""The same by a threshold, of a source 20 times as bright: pixels at its edge make it larger and darker, and
UGR too low; with 25 pixels it is 1.4."""
_COUNTS = 0.01
"""Of the sum over sources: one that brings less may have any solid angle."""


@dataclass(frozen=True, slots=True)
class View:
    """How an eye looks at an image."""

    azimuth_degrees: float = 0.0
    """To the right of the image's middle."""
    elevation_degrees: float = 0.0
    """Above the image's middle."""
    threshold: float | None = None
    """cd/m2 from which a pixel is part of a source. None: UGR's sources are luminaires where the image tells
    them; else, and DGP's, by DEFAULT_THRESHOLD."""


@dataclass(frozen=True, slots=True)
class Glare:
    """How much an eye is disturbed; errors are standard errors to first order, NaN where they are not
    known."""

    ugr: float
    """NaN where there is no source, or nothing else: the logarithm of 0."""
    ugr_error: float
    dgp: float
    dgp_error: float
    vertical_illuminance: float
    """At the eye, lx."""
    vertical_illuminance_error: float
    background_luminance: float
    """Of UGR, cd/m2."""
    sources: tuple[GlareSource, ...]
    """Of UGR; those that count most first."""
    dgp_sources: tuple[GlareSource, ...]
    """Of DGP; those that count most first."""
    notes: tuple[str, ...]
    """Values outside of the range for which a formula was made, and other causes of uncertainty."""


def glare_of(
    image: ImageMoments,
    quantity: Quantity,
    projection: Projection,
    view: View,
    field_degrees: float = 180.0,
    emission: NDArray[np.floating[Any]] | None = None,
) -> Glare:
    """Of an image of luminance all around or through a fisheye. `emission`: the layer of that name, shape
    (height, width), if the image has it. Raises InputError for other images and views."""
    if quantity is not LUMINANCE:
        raise InputError.at(
            "$", f"glare is made of luminance in cd/m2, and this image is of {quantity.name or 'Y'}"
        )
    height, width = image.samples.shape
    if width * height > MAX_PIXELS:
        raise InputError.at("$", f"{width} x {height} pixels; glare is taken of {MAX_PIXELS} at most")
    if not (image.samples > 0).all():
        raise InputError.at("$", "some pixels have no samples yet")
    threshold = DEFAULT_THRESHOLD if view.threshold is None else view.threshold
    if not (threshold > 0.0 and abs(view.elevation_degrees) <= 90.0 and math.isfinite(view.azimuth_degrees)):
        raise InputError.at("$", "expected a threshold above 0 cd/m2 and an elevation from -90 to 90 degrees")
    if emission is not None and not np.all(np.abs(emission - 0.5) <= 0.5):
        raise InputError.at("$", "expected parts of pixels, from 0 to 1, in the layer emission")
    seen = _turned(directions_of(projection, width, height, field_degrees), view)
    reading = read_region(image)
    factor = reading.correlation if reading else 1.0
    known = bool((image.samples > 1).all())
    variance = image.variance[..., 1] * factor if known else np.full(image.samples.shape, np.nan)
    luminance, wraps = image.mean[..., 1], projection == "panorama"
    bright = brighter_than(luminance, threshold, seen, wraps)
    glaring, by_luminaires = bright, False
    if emission is not None and view.threshold is None:
        glaring = of_luminaires(luminance, emission.astype(np.float64), seen, wraps)
        by_luminaires = True
    found = _glare(luminance, variance, seen, glaring, bright)
    notes = [*_notes(found, seen), *_notes_on_size(found, glaring.labels.shape, by_luminaires=by_luminaires)]
    if not by_luminaires and view.threshold is None:
        notes.append(
            f"the image has no layer emission: UGR's sources are pixels of {threshold:g} cd/m2 and more, and "
            "luminaires below that are left out; a lower threshold takes them in"
        )
    if not found.sources:
        why = (
            "no luminaire is in sight; turn the eye, or give a threshold in cd/m2 where something else glares"
        )
        notes.append(
            f"UGR is not known: {why if by_luminaires else f'nothing has {threshold:g} cd/m2 or more'}"
        )
    elif math.isnan(found.ugr):
        notes.append("UGR is not known: there is no light but that of its sources")
    return replace(found, notes=tuple(notes))


def position_index(right: Values, up: Values, forward: Values) -> Values:
    """Of directions seen by an eye, forward above 0; 1 in the line of sight."""
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
    return np.where(up < 0.0, iwata, guth)


def _turned(seen: PixelDirections, view: View) -> PixelDirections:
    """As the eye sees them: its line of sight forward. Pixels behind it have no solid angle."""
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


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    """Of L_s^2 w_s / p_s^2 over sources."""

    sources: tuple[GlareSource, ...]
    """Those that count most first."""
    value: float
    changed: Values
    """How it changes with each pixel's luminance: 2 L_s w / p_s^2, as L_s is a mean over solid angle."""


def _sum_over(glaring: Glaring, seen: PixelDirections, most: float = math.inf) -> _Sum:
    """With the mean luminance of each source and the position of its middle, weighed by luminance; `most`:
    of its index."""
    solid_angle = glaring.summed(glaring.part * seen.solid_angle)
    flux = glaring.summed(glaring.own * seen.solid_angle)
    weight = np.maximum(glaring.own, 0.0) * seen.solid_angle
    middle = [glaring.summed(weight * seen.direction[..., axis]) for axis in range(3)]
    length = np.sqrt(middle[0] ** 2 + middle[1] ** 2 + middle[2] ** 2)
    # What noise leaves without light is no source.
    lit = (flux > 0.0) & (length > 0.0)
    right, up, forward = (np.where(lit, axis / np.where(lit, length, 1.0), 0.0) for axis in middle)
    index = np.minimum(position_index(right, up, forward), most)
    luminance = np.where(lit, flux / solid_angle, 0.0)
    rows = zip(
        luminance,
        solid_angle,
        index,
        np.rad2deg(np.arctan2(right, forward)),
        np.rad2deg(np.arcsin(np.clip(up, -1.0, 1.0))),
        glaring.summed(glaring.part),
        strict=True,
    )
    found = [GlareSource(*map(float, row)) for row, kept in zip(rows, lit, strict=True) if kept]
    slope = glaring.spread(2.0 * luminance / index**2) * seen.solid_angle
    return _Sum(
        tuple(sorted(found, key=lambda source: -source.brings)),
        sum(source.brings for source in found),
        glaring.changed(slope),
    )


def _glare(
    luminance: Values, variance: Values, seen: PixelDirections, glaring: Glaring, bright: Glaring
) -> Glare:
    """UGR by `glaring`, DGP by `bright`; without notes."""
    projected = seen.solid_angle * np.maximum(seen.direction[..., 2], 0.0)
    illuminance = float(np.sum(luminance * projected))
    of_ugr = _sum_over(glaring, seen)
    of_dgp = _sum_over(bright, seen, _MOST_INDEX)

    surrounding = float(np.sum((luminance - glaring.own) * projected)) / math.pi
    ugr, ugr_error = math.nan, math.nan
    if of_ugr.value > 0.0 and surrounding > 0.0:
        ugr = 8.0 * math.log10(0.25 / surrounding * of_ugr.value)
        of_surrounding = (projected - glaring.changed(projected)) / math.pi
        slope = of_ugr.changed / of_ugr.value - of_surrounding / surrounding
        ugr_error = _error((8.0 / math.log(10.0)) * slope, variance)
    dgp, dgp_error = math.nan, math.nan
    if illuminance > 0.0:
        ratio = of_dgp.value / illuminance**1.87
        dgp = 5.87e-5 * illuminance + 9.18e-2 * math.log10(1.0 + ratio) + 0.16
        of_ratio = of_dgp.changed / illuminance**1.87 - (1.87 * ratio / illuminance) * projected
        dgp_error = _error(
            5.87e-5 * projected + (9.18e-2 / math.log(10.0) / (1.0 + ratio)) * of_ratio, variance
        )
    return Glare(
        ugr,
        ugr_error,
        dgp,
        dgp_error,
        illuminance,
        _error(projected, variance),
        surrounding,
        of_ugr.sources,
        of_dgp.sources,
        notes=(),
    )


def _error(slope: Values, variance: Values) -> float:
    return float(np.sqrt(np.sum(slope**2 * variance)))


def _notes(found: Glare, seen: PixelDirections) -> Iterator[str]:
    if float(seen.solid_angle.sum()) < 0.99 * 2 * math.pi:
        yield "the image does not hold the whole half space before the eye: E_v and both ratings are too low"
    low, high = UGR_SOLID_ANGLES
    outside = sum(not low <= source.solid_angle <= high for source in found.sources)
    if outside:
        yield f"UGR is for sources of {low:g} to {high:g} sr; {outside} of {len(found.sources)} are not"
    beyond = [each.brings for each in found.sources if _is_beyond_table(each)]
    part = sum(beyond) / sum(each.brings for each in found.sources) if beyond else 0.0
    if _COUNTS < part < 1.0 and not math.isnan(found.ugr):
        yield (
            f"{len(beyond)} of {len(found.sources)} sources are beyond the table of position indices of CIE "
            f"117, which leaves them out: without them UGR is {found.ugr + 8.0 * math.log10(1.0 - part):.1f}"
        )
    if found.vertical_illuminance < DGP_MIN_ILLUMINANCE:
        lux = found.vertical_illuminance
        yield f"DGP is for {DGP_MIN_ILLUMINANCE:g} lx at the eye and more; here are {lux:.4g} lx"
    elif not DGP_RANGE[0] <= found.dgp <= DGP_RANGE[1]:
        yield f"DGP is for values from {DGP_RANGE[0]:g} to {DGP_RANGE[1]:g}"


def _is_beyond_table(source: GlareSource) -> bool:
    azimuth, elevation = math.radians(source.azimuth_degrees), math.radians(source.elevation_degrees)
    aside, up = abs(math.tan(azimuth)), math.tan(elevation) / max(math.cos(azimuth), 1e-9)
    return up > 0.0 and (aside > TABLE_ENDS[0] or up > TABLE_ENDS[1])


def _notes_on_size(found: Glare, film: tuple[int, ...], *, by_luminaires: bool) -> Iterator[str]:
    """Where a source has so few pixels that its solid angle is uncertain."""
    fewest, most_wrong, how = _FEWEST_WHOLE_PIXELS, _ERROR_OF_FEWEST_WHOLE, "too low"
    if by_luminaires:
        fewest, most_wrong, how = _FEWEST_PIXELS, _ERROR_OF_FEWEST, "wrong"
    total = sum(source.brings for source in found.sources)
    small = [each.pixels for each in found.sources if each.pixels < fewest and each.brings > _COUNTS * total]
    if small:
        yield (
            f"UGR may be {how} by more than {most_wrong}: {len(small)} of {len(found.sources)} sources have "
            f"fewer than {fewest} pixels, which their solid angles need; {_larger(film, fewest / min(small))}"
        )


def _larger(film: tuple[int, ...], times: float) -> str:
    """What film has so many times the pixels; its height is one of 16s."""
    height, width = film
    higher = 16 * math.ceil(height * math.sqrt(times) / 16)
    wider = round(higher * width / height)
    if wider * higher > MAX_PIXELS:
        return f"that takes more than {MAX_PIXELS} pixels, of which glare is not taken"
    return f"a film of {wider} x {higher} would do"
