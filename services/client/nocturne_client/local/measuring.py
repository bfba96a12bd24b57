"""`nocturne measure` and `nocturne glare` of EXR files: the same formulas as the service's."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.compare.images import Picture, read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.layers import CHANNELS, Values
from nocturne_scene.photometry import glare, measuring
from nocturne_scene.photometry.arriving_light import ColourValue, colour_of
from nocturne_scene.photometry.directions import Projection
from nocturne_scene.photometry.glare_sources import GlareSource
from nocturne_scene.photometry.outlines import Kind, Outline
from nocturne_scene.photometry.places import ATTRIBUTE, Places
from nocturne_scene.photometry.point_illuminances import PointReading, point_reading
from nocturne_scene.quantities import LUMINANCE, Quantity, quantity_named
from nocturne_scene.tile_sums import PRODUCTS, blocks_in
from nocturne_scene.uncertainty import ImageMoments

from nocturne_client import contract
from nocturne_client.errors import NocturneClientError, Problem


def measure_file(
    image: Path, outlines: Sequence[contract.Outline], channel: str, bins: int, *, colour: bool = False
) -> contract.Measurements:
    """What parts of an image show, or all of it. Raises NocturneClientError."""
    try:
        picture = read_picture(image)
        quantity, moments = _quantity(image), _moments(picture)
        if channel not in picture.names:
            expected = ", ".join(picture.names)
            raise InputError.at(str(image), f"{channel!r} is not known; expected {expected}")
        name, unit = quantity.of_channel(channel, picture.names)
        height, width = moments.samples.shape
        places = Places.read(_attribute(image, ATTRIBUTE), width, height)
        wanted = [(each.name, _outline(each)) for each in outlines] or places.outlines()
        wanted = wanted or [("", Outline("rectangle", ((0.0, 0.0), (float(width), float(height)))))]
        for _, outline in wanted:
            outline.check(width, height, outline.kind)
        index = picture.names.index(channel)
        found = [(text, outline, _measured(moments, outline, index)) for text, outline in wanted]
        colours = [colour_of(each.reading, picture.names, quantity) if colour else [] for *_, each in found]
        of_outdoor = dict(places.outlines()).get(places.outdoor)
        outdoor = _measured(moments, of_outdoor, index) if of_outdoor else None
    except InputError as error:
        raise _refused(error) from error
    return contract.Measurements(
        quantity=name,
        unit=unit,
        channel=channel,
        measurements=[
            _measurement(
                contract.Outline(text, outline.kind, [[x, y] for x, y in outline.points]),
                (one, places),
                _histogram(moments, outline, one, index, bins),
                (name, unit),
                of_light,
                None if outdoor is None else measuring.daylight_factor(one, outdoor),
            )
            for (text, outline, one), of_light in zip(found, colours, strict=True)
        ],
        csv=measuring.as_csv(found, name, unit),
    )


def glare_of_file(
    image: Path, projection: str, field_degrees: float, view: tuple[float, float, float | None]
) -> contract.Glare:
    """`view`: azimuth and elevation in degrees, and the luminance of what glares, if it is to go by that.
    Raises NocturneClientError."""
    eye = glare.View(*view)
    try:
        moments = _moments(read_picture(image))
        quantity = _quantity(image)
        # Of other programs' images nothing is known; who asks for glare says that they are luminance.
        seen = quantity if quantity.name else LUMINANCE
        emission = _channel(image, *CHANNELS["emission"])
        found = glare.glare_of(moments, seen, cast("Projection", projection), eye, field_degrees, emission)
    except InputError as error:
        raise _refused(error) from error
    return contract.Glare(
        ugr=_known(found.ugr),
        ugr_error=_known(found.ugr_error),
        dgp=_known(found.dgp),
        dgp_error=_known(found.dgp_error),
        vertical_illuminance=found.vertical_illuminance,
        vertical_illuminance_error=_known(found.vertical_illuminance_error),
        background_luminance=found.background_luminance,
        sources=_sources(found.sources),
        dgp_sources=_sources(found.dgp_sources),
        notes=[*_of_another_camera(projection, moments.samples.shape), *found.notes],
    )


def point_of_file(image: Path, azimuth_degrees: float) -> PointReading:
    """What the point of a panorama receives. Raises NocturneClientError."""
    try:
        return point_reading(_moments(read_picture(image)), _quantity(image), azimuth_degrees)
    except InputError as error:
        raise _refused(error) from error


def _of_another_camera(projection: str, shape: tuple[int, ...]) -> list[str]:
    """Notes on the image's shape, the only thing that a file says of its camera."""
    height, width = shape
    if projection != "panorama" or width == 2 * height:
        return []
    return [
        f"{width} x {height} pixels are rated as a panorama, which is usually twice as wide as high: a file "
        "does not say of which sensor it is, and of another camera's image these numbers are wrong"
    ]


def _sources(found: Sequence[GlareSource]) -> list[contract.GlareSource]:
    return [
        contract.GlareSource(
            each.luminance,
            each.solid_angle,
            each.position_index,
            each.azimuth_degrees,
            each.elevation_degrees,
        )
        for each in found
    ]


def _channel(image: Path, name: str) -> Values | None:
    """None where a file that can be read has none of that name."""
    picture = oiio.ImageBuf(str(image))
    names = [*picture.spec().channelnames]
    return np.asarray(picture.get_pixels(oiio.FLOAT))[..., names.index(name)] if name in names else None


def _quantity(image: Path) -> Quantity:
    return quantity_named(_attribute(image, "nocturne:quantity"))


def _attribute(image: Path, name: str) -> str:
    """Empty where a file that can be read has none of that name."""
    return str(oiio.ImageBuf(str(image)).spec().getattribute(name) or "")


def _moments(picture: Picture) -> ImageMoments:
    """Of other programs' images no error is known, as of one sample."""
    if picture.moments is not None:
        return picture.moments
    height, width = picture.xyz.shape[:2]
    unknown = np.full(picture.xyz.shape, np.nan)
    blocks = np.full((blocks_in(height), blocks_in(width), PRODUCTS), np.nan)
    samples = np.ones((height, width), dtype=np.uint32)
    return ImageMoments(
        picture.xyz,
        unknown,
        unknown,
        unknown,
        blocks,
        np.full((1, 1, 3), np.nan),
        max(width, height),
        samples,
    )


def _measured(moments: ImageMoments, outline: Outline, index: int) -> measuring.Measured:
    adding = measuring.Measuring(outline, moments.mean.shape[-1], index)
    adding.add(moments, 0, 0)
    found = adding.measured()
    if found is None:
        raise InputError.at(outline.kind, "has no samples")
    return found


def _histogram(
    moments: ImageMoments, outline: Outline, found: measuring.Measured, index: int, bins: int
) -> contract.Histogram | None:
    if not bins:
        return None
    height, width = moments.samples.shape
    chosen = outline.mask(0, 0, width, height) & (moments.samples > 0)
    counted = measuring.Histogram(*measuring.histogram_range(found, 0.0, 0.0, False), bins, False)
    counted.add(moments.mean[chosen][:, index])
    return contract.Histogram(counted.edges().tolist(), counted.counts.tolist(), counted.outside, False)


def _measurement(
    outline: contract.Outline,
    measured: tuple[measuring.Measured, Places],
    histogram: contract.Histogram | None,
    named: tuple[str, str],
    colour: Sequence[ColourValue],
    daylight: measuring.DaylightFactor | None,
) -> contract.Measurement:
    found, places = measured
    numbers: dict[str, Any] = {
        each: _known(getattr(found, each)) for each in ("mean_error", "u0", "u0_error", "ud", "ud_error")
    }
    return contract.Measurement(
        outline=outline,
        pixels=found.pixels,
        unseen_pixels=found.unseen_pixels,
        mean=found.mean,
        minimum=_pixel(found.minimum, places),
        maximum=_pixel(found.maximum, places),
        profile=[_pixel(each, places) for each in found.profile],
        profile_csv=measuring.profile_as_csv(found, *named) if found.profile else "",
        histogram=histogram,
        colour=[
            contract.ColourValue(each.name, _known(each.value), _known(each.error), each.unit)
            for each in colour
        ],
        daylight_factor=None if daylight is None else _daylight(daylight),
        **numbers,
    )


def _daylight(found: measuring.DaylightFactor) -> contract.DaylightFactor:
    return contract.DaylightFactor(
        found.mean, _known(found.mean_error), found.minimum, _known(found.minimum_error)
    )


def _pixel(pixel: measuring.PixelValue, places: Places) -> contract.PixelValue:
    place = places.place(pixel.x, pixel.y)
    known = None if place is None else [*place]
    return contract.PixelValue(pixel.x, pixel.y, pixel.value, _known(pixel.standard_error), known)


def _outline(outline: contract.Outline) -> Outline:
    return Outline(cast("Kind", outline.kind), tuple((x, y) for x, y in outline.points))


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value


def _refused(error: InputError) -> NocturneClientError:
    problems = [Problem(each.place, each.message) for each in error.problems]
    return NocturneClientError("the image can't be measured", problems=problems)
