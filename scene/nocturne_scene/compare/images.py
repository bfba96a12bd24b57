"""OpenEXR files as images in XYZ, with their noise where they tell it."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene import response_correlations
from nocturne_scene.errors import InputError
from nocturne_scene.library_words import said_by
from nocturne_scene.picture_windows import in_window, windows_of
from nocturne_scene.spectra.published import SRGB_TO_XYZ
from nocturne_scene.tile_sums import (
    BLOCK,
    PAIR_FIRST,
    PAIR_SECOND,
    PAIRS,
    PRODUCTS_SQUARES,
    block_sums,
    tile_sums,
)
from nocturne_scene.uncertainty import ImageMoments

Values = NDArray[np.float64]

_TOGETHER = frozenset(
    (
        *(f"{pair}.{what}" for pair in PAIRS for what in ("correlation", "blockCorrelation")),
        *(f"{each}.{what}" for each in "XYZ" for what in ("blockRatio", "ownRatio", "tileRatio")),
    )
)
"""How errors go together."""

_MAX_PIXELS = 2**26
_MAX_CHANNELS = 192


@dataclass(frozen=True)
class Picture:
    """An image file."""

    xyz: Values
    """Shape (height, width, 3)."""
    y_error: Values | None
    """Standard error of Y, shape (height, width), if the file has it."""
    samples: Values | None
    """Per pixel, shape (height, width), if the file has them."""
    moments: ImageMoments | None = None
    """Of all quantities, if the file is one of ours that has their errors."""
    names: tuple[str, ...] = ("X", "Y", "Z")
    """Of what `moments` has."""


def read_picture(file: Path, max_pixels: int = _MAX_PIXELS) -> Picture:
    """Read channels X, Y, Z or else R, G, B (linear sRGB), or Y alone for all three: what the display window
    shows, 0 outside of the data window. Raises InputError."""
    picture = oiio.ImageInput.open(str(file))
    if picture is None:
        raise InputError.at(str(file), f"no image that can be read: {said_by(oiio.geterror)}")
    try:
        spec = picture.spec()
        names = list(spec.channelnames)
        data, display = windows_of(spec)
        for width, height in (data[2:], display[2:]):
            if not (0 < width * height <= max_pixels and spec.nchannels <= _MAX_CHANNELS):
                raise InputError.at(str(file), f"{width} x {height} pixels are too many")
        colour = next((each for each in ("XYZ", "RGB", "YYY") if all(name in names for name in each)), None)
        if colour is None:
            found = ", ".join(names)[:200]
            raise InputError.at(str(file), f"expected channels X, Y, Z or R, G, B or Y; found {found}")
        wanted = [*colour, *_of_errors(names)]
        channels = {}
        for name in wanted:
            index = names.index(name)
            # Asked for floats, OpenImageIO takes the largest uint for 1.
            kind = oiio.UINT if spec.channelformat(index) == oiio.TypeUInt else oiio.FLOAT
            values = picture.read_image(0, 0, index, index + 1, kind)
            if values is None:
                raise InputError.at(str(file), f"can't be read: {said_by(picture.geterror)}")
            channels[name] = in_window(np.asarray(values, dtype=np.float64)[..., 0], data, display)
        schedule = spec.get_string_attribute("nocturne:schedule")
        together = spec.get_string_attribute(response_correlations.ATTRIBUTE)
    finally:
        picture.close()
    pixels = np.stack([channels[name] for name in colour], axis=-1)
    if not np.all(np.isfinite(pixels)):
        raise InputError.at(str(file), "holds values that are not finite")
    xyz = pixels @ SRGB_TO_XYZ.T if colour == "RGB" else pixels
    read = Picture(xyz, channels.get("Y.stderr"), channels.get("n"))
    # Blocks of a part of an image are not where those of the whole were.
    whole = data == display and channels.keys() >= _TOGETHER
    return _with_moments(read, channels, schedule, together) if whole else read


def _of_errors(names: Sequence[str]) -> list[str]:
    """Channels that tell errors, and the values that they are of."""
    if not {*_TOGETHER, "n", *(f"{each}.stderr" for each in "XYZ")} <= {*names}:
        return [name for name in ("Y.stderr", "n") if name in names]
    errors = [name for name in names if name.endswith(".stderr")]
    further = {name.removesuffix(".stderr") for name in errors} - {*"XYZ"}
    return [*errors, *sorted(further), *sorted(_TOGETHER), "n"]


def _with_moments(
    picture: Picture, channels: Mapping[str, Values], schedule: str, correlations: str
) -> Picture:
    known = {name.removesuffix(".stderr") for name in channels if name.endswith(".stderr")}
    names = ("X", "Y", "Z", *sorted(known - {*"XYZ"}))
    edge = int(json.loads(schedule)["tileSize"]) if schedule else max(picture.xyz.shape)
    error = np.stack([channels[f"{name}.stderr"] for name in names], axis=-1)
    # Of further responses the same part as of Y.
    own_ratio = _planes(channels, "XYZ", "ownRatio")[..., [0, 1, 2, *[1] * (len(names) - 3)]]
    variance = error**2 * own_ratio
    of_blocks = block_sums(variance[..., :3]) * _planes(channels, "XYZ", "blockRatio")[::BLOCK, ::BLOCK]
    of_tiles = tile_sums(of_blocks, edge) * _planes(channels, "XYZ", "tileRatio")[::edge, ::edge]
    together = _planes(channels, PAIRS, "blockCorrelation")[::BLOCK, ::BLOCK]
    products = _covariance(together, np.sqrt(of_blocks))
    moments = ImageMoments(
        np.stack([channels[name] for name in names], axis=-1),
        variance,
        error**2 - variance,
        _covariance(_planes(channels, PAIRS, "correlation"), np.sqrt(variance)),
        np.concatenate([of_blocks[..., PRODUCTS_SQUARES], products], axis=-1),
        of_tiles,
        edge,
        channels["n"].astype(np.uint32),
        _correlations(correlations, names, schedule, of_tiles.shape),
    )
    return replace(picture, moments=moments, names=names)


def _correlations(text: str, names: Sequence[str], schedule: str, tiles: tuple[int, ...]) -> Values | None:
    """In the order of `names`: in the file they are in that of the schedule."""
    if not (text and schedule):
        return None
    own = ["X", "Y", "Z", *json.loads(schedule).get("furtherResponses", ())]
    if sorted(own) != sorted(names):
        return None
    found = response_correlations.decode(text, (tiles[0], tiles[1]), len(names))
    if found is None:
        return None
    order = [own.index(name) for name in names]
    rows, columns = np.tril_indices(len(names), -1)
    places = np.zeros((len(names), len(names)), dtype=np.int64)
    places[rows, columns] = places[columns, rows] = np.arange(len(rows))
    return found[..., places[np.ix_(order, order)][rows, columns]]


def _planes(channels: Mapping[str, Values], of: Iterable[str], what: str) -> Values:
    return np.stack([channels[f"{each}.{what}"] for each in of], axis=-1)


def _covariance(correlation: Values, error: Values) -> Values:
    found: Values = correlation * error[..., PAIR_FIRST] * error[..., PAIR_SECOND]
    return found


def write_difference(file: Path, image: Values, reference: Values) -> None:
    """Write a PNG: red where the image's Y is more than the reference's, blue where it is less.

    Full colour is 25 % of the pixel's Y plus a tenth of the mean. Raises InputError.
    """
    scale = 0.25 * (np.abs(reference) + 0.1 * max(float(np.abs(reference).mean()), 1e-30))
    off = np.clip((image - reference) / scale, -1, 1)
    red, blue = np.where(off < 0, 1 + off, 1.0), np.where(off > 0, 1 - off, 1.0)
    pixels = np.rint(255 * np.stack([red, 1 - np.abs(off), blue], axis=-1)).astype(np.uint8)
    output = oiio.ImageOutput.create(str(file))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.UINT8)
    if output is None or not output.open(str(file), spec):
        raise InputError.at(str(file), f"can't be written: {said_by(oiio.geterror)}")
    output.write_image(np.ascontiguousarray(pixels))
    output.close()
