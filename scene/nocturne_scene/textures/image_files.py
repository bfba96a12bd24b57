"""Pictures become texture files of linear values."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

from nocturne_scene.library_words import said_by
from nocturne_scene.textures import texture_files
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

# Pixels; as float32 in three channels 768 MiB while it is made.
MAX_PIXELS = 2**26
MAX_EDGE = 16384

Encoding = Literal["srgb", "linear"]

# A texture's numbers beyond this can't be reflectances, weights, normals or heights.
LARGEST = 1e6

# Of a number of eight bits, as OpenImageIO reads it.
_OF_CODES = np.arange(256, dtype=np.float32) * np.float32(1.0 / 255.0)


@dataclass(frozen=True)
class TextureFile:
    """What the tracer reads, and its smallest and largest number."""

    content: bytes
    least: float
    most: float


def convert(source: Path, channels: Literal[1, 3], encoding: Encoding) -> TextureFile:
    """Return the texture file of a PNG, JPEG, TIFF, EXR or HDR picture.

    `srgb`: values are decoded by IEC 61966-2-1. One channel of a colour picture is its luminance (after
    decoding); a grey picture as three channels has three equal ones. Opacity (alpha) is left out. 8-bit
    values stay such; luminances and means of them are kept in 16-bit floats. Other values are kept in those
    if they all are such, and their means in 32-bit ones. Raises UnusableImageError.
    """
    with opened(source) as picture:
        spec = picture.spec()
        check_size(spec, MAX_PIXELS, MAX_EDGE)
        pixels = picture.read_image(0, 0, 0, 3 if spec.nchannels >= 3 else 1, oiio.FLOAT)
        if pixels is None:
            raise UnusableImageError(f"the picture can't be read: {said_by(picture.geterror)}")
        narrow = spec.format.basetype == oiio.UINT8
    values = np.asarray(pixels, dtype=np.float32).reshape(spec.height, spec.width, -1)
    if not np.all(np.abs(values) <= LARGEST):
        raise UnusableImageError(
            f"the picture holds infinite or undefined numbers, or some beyond {LARGEST:g}"
        )
    if narrow and not (values.shape[2] == 3 and channels == 1):
        codes = np.rint(values * np.float32(255.0)).astype(np.uint8)
        table = _linear(_OF_CODES, encoding)
        kept = table.astype(np.float16)[codes]
        content = texture_files.packed_codes(_with_channels(codes, channels), table)
    else:
        values = _with_channels(_linear(values, encoding), channels)
        kept = values.astype(np.float16) if narrow else values
        content = texture_files.packed(values, narrow=narrow)
    return TextureFile(content, float(kept.min()), float(kept.max()))


def _linear(values: Any, encoding: Encoding) -> Any:
    return decoded(values) if encoding == "srgb" else values


def decoded(values: Any) -> Any:
    """sRGB to linear, IEC 61966-2-1; negative numbers stay as they are."""
    high = ((np.maximum(values, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(values <= 0.04045, values / 12.92, high).astype(np.float32)


def _with_channels(values: Any, channels: int) -> Any:
    if values.shape[2] == channels:
        return values
    if channels == 3:
        return np.repeat(values, 3, axis=2)
    return (values @ np.array(_LUMINANCE, dtype=np.float32))[..., None]


# Y of linear sRGB, IEC 61966-2-1.
_LUMINANCE: tuple[float, float, float] = (0.2126, 0.7152, 0.0722)
