"""Environment maps: a latitude-longitude picture in linear sRGB becomes equal-area texels of the compiled
scene.

The picture: the rows are equal steps of the angle from +z (above) to -z, the columns equal steps of azimuth
over the full circle. +x of the map's frame is in the middle of the picture, +y (to the left for someone
inside who looks along +x with +z up) at a quarter of its width. A pixel is an area, not a point: with width
w, the middle of column i is at azimuth pi - 2 pi (i + 1/2) / w.

Texels: rows of equal steps of z, columns of equal steps of azimuth from +x towards +y. Each is the mean
radiance of the picture over its area, so that the picture's flux over any whole rows or columns of texels,
and over the sphere, is kept; a pixel at the pole is narrow there and fills a part of the first row.
"""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.library_words import said_by
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.rgb import emission_of_pixels
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

# Pixels: 8192 x 4096; the texels then fill 512 MiB.
MAX_PIXELS = 2**25
MAX_EDGE = 16384

# Linear sRGB. Sums over the sphere stay finite in float32.
LARGEST = 1e15

# A picture whose values are interpolated is made finer, as many times as it then has no more pixels than
# this: 2048 x 1024, whose texels are a sixth of a degree wide.
_FINER = (4, 2)
_FINE_PIXELS = 2**21

# Rows whose spectra are looked up in one go.
_TOGETHER = 16

_Pixels = NDArray[np.float32]


def convert(source: Path, target: BinaryIO, *, points: bool = False) -> tuple[int, int]:
    """Write the texels of `EnvironmentMap.blob` for an HDR or EXR file; return columns and rows.

    As many columns and rows as the picture has, or of `points` up to four times as many. Radiance is texel x
    spectrum, with the spectrum that `rgb_spectra.d65_of_luminance` gives for the luminance of RGB (1, 1, 1).
    Negative values become 0. Uses memory for some rows of the picture, or for all of `points`. Raises
    UnusableImageError.
    """
    with opened(source) as picture:
        spec = picture.spec()
        _check_shape(spec)
        rows, count, columns = _rows(picture, spec), spec.height, spec.width
        if points:
            rows, count, columns = interpolated(np.stack(list(rows)))
        texels = map(turned, equal_area_rows(rows, count))
        while block := list(islice(texels, _TOGETHER)):
            colours = np.concatenate(block).astype(np.float32)
            target.write(emission_of_pixels(colours).astype("<f4", copy=False).tobytes())
        return columns, count


def polar_change(source: Path) -> float:
    """By which part the light on a surface that faces a pole changes where a picture becomes texels.

    Of the pole with more light. Raises UnusableImageError.
    """
    with opened(source) as picture:
        spec = picture.spec()
        _check_shape(spec)
        count = spec.height
        means = np.array([row.mean(axis=0, keepdims=True) for row in _rows(picture, spec)])
    texels = np.array(list(equal_area_rows(iter(means), count)))
    before, after = (
        np.array([_irradiance(rows.mean(axis=(1, 2)), side * edges) for side in (1.0, -1.0)])
        for rows, edges in (
            (means, np.cos(np.pi * np.arange(count + 1) / count)),
            (texels, 1.0 - 2.0 * np.arange(count + 1) / count),
        )
    )
    largest = float(before.max())
    return float(np.abs(after - before).max()) / largest if largest > 0.0 else 0.0


def _irradiance(rows: Floats, edges: Floats) -> float:
    """Of a surface that faces a pole, over pi; `edges` of the rows are cosines to that pole."""
    squares = np.clip(edges, 0.0, 1.0) ** 2
    return float(np.abs(np.diff(squares)) @ rows)


def interpolated(pixels: _Pixels) -> tuple[Iterator[_Pixels], int, int]:
    """Rows, their number and that of columns of a picture whose values lie at points: finer, as areas.

    The first and last row lie on the poles, columns in the middle of their areas. Brightness and colour are
    interpolated each for itself, linearly.
    """
    rows, columns = pixels.shape[:2]
    finer = next((each for each in _FINER if rows * columns * each**2 <= _FINE_PIXELS), 1)
    brightness = pixels.max(axis=2, keepdims=True)
    colour = pixels / np.maximum(brightness, np.float32(1e-8))
    x = (np.arange(finer * columns) + 0.5) / finer - 0.5
    left = np.floor(x).astype(int)
    across = (x - left).astype(np.float32)[:, None]
    left, right = left % columns, (left + 1) % columns

    def wide(row: _Pixels) -> _Pixels:
        return np.asarray((1 - across) * row[left] + across * row[right])

    def found() -> Iterator[_Pixels]:
        for y in (np.arange(finer * rows) + 0.5) / (finer * rows) * (rows - 1):
            top = min(int(y), rows - 2)
            down = np.float32(y - top)
            bright, tint = (
                (1 - down) * wide(values[top]) + down * wide(values[top + 1])
                for values in (brightness, colour)
            )
            yield bright * tint

    return found(), finer * rows, finer * columns


def equal_area_rows(rows: Iterator[_Pixels], count: int) -> Iterator[Floats]:
    """Turn `count` rows of equal steps of the polar angle into as many of equal steps of its cosine, from 1
    to -1.

    Each row has the shape (columns, 3). Mean values over areas; holds two rows at a time.
    """
    # Edges as z; rows of the picture shrink towards the poles.
    edges = np.cos(np.pi * np.arange(count + 1) / count)
    edges[-1] = -1.0
    index, row = 0, next(rows).astype(np.float64)
    for texel in range(count):
        top, bottom = 1 - 2 * texel / count, 1 - 2 * (texel + 1) / count
        total = np.zeros_like(row)
        while True:
            overlap = min(top, edges[index]) - max(bottom, edges[index + 1])
            total += max(overlap, 0.0) * row
            if edges[index + 1] <= bottom or index + 1 == count:
                break
            index, row = index + 1, next(rows).astype(np.float64)
        yield total / (top - bottom)


def turned(row: Floats) -> Floats:
    """Order columns by azimuth from +x towards +y: mirrored, and turned by half the width.

    With an odd width that is half a column, and each is the mean of two.
    """
    mirrored = row[::-1]
    width = len(row)
    if width % 2 == 0:
        return np.roll(mirrored, -(width // 2), axis=0)
    return (np.roll(mirrored, -(width // 2), axis=0) + np.roll(mirrored, -(width // 2 + 1), axis=0)) / 2


def read_whole(source: Path) -> _Pixels:
    """Red, green, blue of all pixels of an HDR or EXR file, none negative; raises UnusableImageError."""
    with opened(source) as picture:
        spec = picture.spec()
        _check_shape(spec)
        return np.stack(list(_rows(picture, spec)))


def _check_shape(spec: Any) -> None:
    check_size(spec, MAX_PIXELS, MAX_EDGE)
    if spec.nchannels not in (3, 4):
        raise UnusableImageError(f"{spec.nchannels} channels; expected red, green, blue")
    if spec.format.basetype not in (oiio.HALF, oiio.FLOAT):
        raise UnusableImageError(
            "the values are no floating-point numbers; expected a Radiance HDR or OpenEXR file"
        )
    if spec.width < 2 or spec.height < 2:
        raise UnusableImageError("an environment map needs at least 2 x 2 pixels")


def _rows(picture: Any, spec: Any) -> Iterator[_Pixels]:
    """Rows of red, green, blue from the top, read a few at a time."""
    step = spec.tile_height or 16
    for start in range(spec.y, spec.y + spec.height, step):
        end = min(start + step, spec.y + spec.height)
        if spec.tile_width:
            across = (spec.x, spec.x + spec.width, start, end, 0, 1)
            pixels = picture.read_tiles(0, 0, *across, 0, 3, oiio.FLOAT)
        else:
            pixels = picture.read_scanlines(0, 0, start, end, 0, 0, 3, oiio.FLOAT)
        if pixels is None:
            raise UnusableImageError(
                f"the rows from {start - spec.y} on can't be read: {said_by(picture.geterror)}"
            )
        block = np.asarray(pixels, dtype=np.float32).reshape(end - start, spec.width, 3)
        if not np.all(np.abs(block) <= LARGEST):
            raise UnusableImageError(
                f"rows {start - spec.y} to {end - spec.y - 1} hold infinite, undefined or too large numbers"
            )
        yield from np.maximum(block, 0)
