"""Texture files: a picture becomes a tiled OpenEXR file with MIP levels and linear values, for the tracer's
texture cache.

Equal pictures give equal bytes: nothing of the source's or the machine's goes into the file but the pixels.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

from nocturne_scene.library_words import said_by
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

# Pixels; as float32 in three channels 768 MiB while it is made.
MAX_PIXELS = 2**26
MAX_EDGE = 16384

Encoding = Literal["srgb", "linear"]

# A texture's numbers beyond this can't be reflectances, weights, normals or heights.
LARGEST = 1e6

_TILE = 64
NO_DATE = "1970:01:01 00:00:00"


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
    values are kept in 16-bit floats, others in 32-bit ones. Raises UnusableImageError.
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
    if encoding == "srgb":
        values = decoded(values)
    values = _with_channels(values, channels)
    kept = values.astype(np.float16) if narrow else values
    return TextureFile(_texture(values, "half" if narrow else "float"), float(kept.min()), float(kept.max()))


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


def _texture(values: Any, kind: Literal["half", "float"]) -> bytes:
    height, width, channels = values.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, oiio.FLOAT))
    if not buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(values)):
        raise UnusableImageError(f"the picture can't be held: {said_by(buffer.geterror)}")
    config = oiio.ImageSpec(oiio.HALF if kind == "half" else oiio.FLOAT)
    config.tile_width = config.tile_height = _TILE
    config.tile_depth = 1
    config.attribute("maketx:fileformatname", "openexr")
    config.attribute("maketx:filtername", "box")
    config.attribute("maketx:hash", 0)
    config.attribute("maketx:full_command_line", "")
    config.attribute("compression", "zip")
    # Would else be the time of day.
    config.attribute("DateTime", NO_DATE)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "texture.exr"
        if not oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, buffer, str(file), config):
            raise UnusableImageError(f"no texture can be made of the picture: {said_by(oiio.geterror)}")
        return file.read_bytes()
