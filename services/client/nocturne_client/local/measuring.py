"""`nocturne measure` and `nocturne glare` of EXR files: the same formulas as the service's."""

import csv
import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.compare.images import Picture, read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.layers import CHANNELS, Values
from nocturne_scene.photometry import glare, measuring
from nocturne_scene.photometry.arriving_light import colour_of
from nocturne_scene.photometry.directions import Projection
from nocturne_scene.photometry.outlines import Kind, Outline
from nocturne_scene.photometry.places import ATTRIBUTE, Places
from nocturne_scene.photometry.plain_values import MeasuredOutline, plain, plain_measurements
from nocturne_scene.photometry.point_illuminances import PointReading, point_reading
from nocturne_scene.quantities import LUMINANCE, Quantity, quantity_named
from nocturne_scene.tile_sums import PRODUCTS, blocks_in
from nocturne_scene.uncertainty import ImageMoments

from nocturne_client import contract
from nocturne_client.decoding import decode
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.failures import client_errors

_REFUSED = "the image can't be measured"


def measure_file(
    image: Path, outlines: Sequence[contract.Outline], channel: str, bins: int, *, colour: bool = False
) -> contract.Measurements:
    """What parts of an image show, or all of it. Raises NocturneClientError."""
    with client_errors(_REFUSED):
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
        of_outdoor = dict(places.outlines()).get(places.outdoor)
        outdoor = _measured(moments, of_outdoor, index) if of_outdoor else None
        found = []
        for text, outline in wanted:
            one = _measured(moments, outline, index)
            of_light = colour_of(one.reading, picture.names, quantity) if colour else []
            daylight = None if outdoor is None else measuring.daylight_factor(one, outdoor)
            histogram = _histogram(moments, outline, one, index, bins) if bins else None
            found.append(MeasuredOutline(text, outline, one, histogram, of_light, daylight))
    told = plain_measurements(found, places, channel, picture.names, (name, unit))
    return decode(contract.Measurements, told)


def meters_as_csv(image: Path, channel: str) -> str:
    """A line for each meter of an image: instrument, number, place in m, value, standard error. Raises
    NocturneClientError."""
    with client_errors(_REFUSED):
        picture = read_picture(image)
        moments, places = _moments(picture), Places.read(_attribute(image, ATTRIBUTE), *_size(picture))
        if not places.is_of_meters:
            raise NocturneClientError(f'{image} has no meters; they are pixels of the sensor "meters"')
        if channel not in picture.names:
            known = ", ".join(picture.names)
            raise NocturneClientError(f"{image}: {channel!r} is not known; expected {known}")
        _, unit = _quantity(image).of_channel(channel, picture.names)
        index = picture.names.index(channel)
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(["instrument", "meter", "x", "y", "z", f"value {unit}".strip(), "standard_error"])
        for part in places.parts:
            for number in range(part.columns * part.rows):
                x, y = part.left + number % part.columns, part.top + number // part.columns
                variance = moments.variance[y, x, index] + moments.one_more[y, x, index]
                error = f"{np.sqrt(variance):.8g}" if moments.samples[y, x] > 1 else ""
                where = (f"{each:.9g}" for each in part.place(x, y) or ())
                lines.writerow([part.name, number, *where, f"{moments.mean[y, x, index]:.8g}", error])
    return text.getvalue()


def _size(picture: Picture) -> tuple[int, int]:
    height, width = picture.xyz.shape[:2]
    return width, height


def glare_of_file(
    image: Path, projection: str, field_degrees: float, view: tuple[float, float, float | None]
) -> contract.Glare:
    """`view`: azimuth and elevation in degrees, and the luminance of what glares, if it is to go by that.
    Raises NocturneClientError."""
    eye = glare.View(*view)
    with client_errors(_REFUSED):
        moments = _moments(read_picture(image))
        quantity = _quantity(image)
        # Of other programs' images nothing is known; who asks for glare says that they are luminance.
        seen = quantity if quantity.name else LUMINANCE
        emission = _channel(image, *CHANNELS["emission"])
        found = glare.glare_of(moments, seen, cast("Projection", projection), eye, field_degrees, emission)
    notes = (*_of_another_camera(projection, moments.samples.shape), *found.notes)
    return decode(contract.Glare, plain(replace(found, notes=notes)))


def point_of_file(image: Path, azimuth_degrees: float) -> PointReading:
    """What the point of a panorama receives. Raises NocturneClientError."""
    with client_errors(_REFUSED):
        return point_reading(_moments(read_picture(image)), _quantity(image), azimuth_degrees)


def _of_another_camera(projection: str, shape: tuple[int, ...]) -> list[str]:
    """Notes on the image's shape, the only thing that a file says of its camera."""
    height, width = shape
    if projection != "panorama" or width == 2 * height:
        return []
    return [
        f"{width} x {height} pixels are rated as a panorama, which is usually twice as wide as high: a file "
        "does not say of which sensor it is, and of another camera's image these numbers are wrong"
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
) -> measuring.Histogram:
    height, width = moments.samples.shape
    chosen = outline.mask(0, 0, width, height) & (moments.samples > 0)
    counted = measuring.Histogram(*measuring.histogram_range(found, 0.0, 0.0, False), bins, False)
    counted.add(moments.mean[chosen][:, index])
    return counted


def _outline(outline: contract.Outline) -> Outline:
    return Outline(cast("Kind", outline.kind), tuple((x, y) for x, y in outline.points))
