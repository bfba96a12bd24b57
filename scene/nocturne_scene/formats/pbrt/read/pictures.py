"""Pictures of pbrt's imagemaps: how their numbers are decoded, and which one of several channels counts.

After pbrt-v4's Image::Read, MIPMap and FloatImageTexture: PNG files are sRGB unless `encoding` says
otherwise, also where they are numbers, and so is their alpha; numbers are the mean of red, green and blue, or
alpha where it is not 1 everywhere.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.textures.image_files import MAX_EDGE, MAX_PIXELS, decoded
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

_Pixels = NDArray[np.float64]

# Formats that pbrt reads as floating-point numbers.
_LINEAR = (".exr", ".hdr", ".pfm")
_PNG_RGBA = 6


@dataclass
class Look:
    """What an imagemap says of its picture."""

    kind: str
    """"float" or "spectrum"."""
    encoding: str
    invert: bool
    factor: float
    """By which it is multiplied before it is inverted."""

    @property
    def factor_left(self) -> float:
        """The factor that is left for the lookup of the picture."""
        return 1.0 if self.invert else self.factor


def texture(writer: SceneWriter, file: Path, look: Look) -> Json:
    """A texture of a file as it is, or of a picture made of it. Raises UnusableImageError."""
    suffix = file.suffix.lower()
    encoding = look.encoding if suffix == ".png" else "linear" if suffix in _LINEAR else "sRGB"
    with opened(file) as picture:
        spec = picture.spec()
        check_size(spec, MAX_PIXELS, MAX_EDGE)
        is_number = look.kind == "float" and spec.nchannels >= 3
        if encoding in ("sRGB", "linear") and not look.invert and not is_number:
            return {"asset": writer.copy(file), "encoding": encoding}
        read = picture.read_image(oiio.FLOAT)
    if read is None:
        raise UnusableImageError("the picture can't be read")
    pixels = _linear(np.atleast_3d(np.asarray(read, dtype=np.float64)), encoding)
    pixels = pixels[..., : 4 if pixels.shape[2] >= 3 else 1]
    if is_number:
        pixels = _numbers(pixels, has_alpha=_keeps_alpha(file))
    pixels = pixels[..., :3]
    if look.invert:
        pixels = np.maximum(1.0 - look.factor * pixels, 0.0)
    return {"asset": writer.picture(file.stem, pixels, narrow=suffix not in _LINEAR), "encoding": "linear"}


def _linear(stored: _Pixels, encoding: str) -> _Pixels:
    """Decoded values. Raises UnusableImageError for an encoding that pbrt does not have."""
    words = encoding.split()
    if words == ["linear"]:
        return stored
    if words == ["sRGB"]:
        return np.asarray(decoded(stored), dtype=np.float64)
    try:
        [name, exponent] = words
        gamma = float(exponent)
    except ValueError:
        name, gamma = "", 0.0
    if name != "gamma" or not 0 < gamma < 100:
        raise UnusableImageError(
            f'no encoding "{encoding[:40]}"; expected sRGB, linear or gamma and a number'
        )
    return np.asarray(np.maximum(stored, 0.0) ** gamma)


def _numbers(pixels: _Pixels, has_alpha: bool) -> _Pixels:
    if has_alpha and pixels.shape[2] == 4 and not np.all(pixels[..., 3] == 1.0):
        return pixels[..., 3:4]
    return np.asarray(pixels[..., :3].mean(axis=2, keepdims=True))


def _keeps_alpha(file: Path) -> bool:
    """Whether pbrt keeps a picture's alpha: of EXR files, and of PNG files that have no palette."""
    if file.suffix.lower() == ".exr":
        return True
    with file.open("rb") as opened_file:
        head = opened_file.read(26)
    return head[1:4] == b"PNG" and head[25] == _PNG_RGBA
