"""Small OpenEXR files, and what one of ours says of itself."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation


def write_exr(path: Path, values: npt.NDArray[np.floating], names: Sequence[str] = "XYZ") -> Path:
    """Values of shape (height, width, channels), a channel for each of `names`."""
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], oiio.FLOAT)
    spec.channelnames = tuple(names)
    output = oiio.ImageOutput.create(str(path))
    assert output is not None
    assert output.open(str(path), spec)
    output.write_image(np.ascontiguousarray(values, dtype=np.float32))
    output.close()
    return path


def samples_of(manifest: str) -> list[int]:
    """The samples of each tile, from the attribute `nocturne:tileSamples`: "64x3 128 64"."""
    samples: list[int] = []
    for run in manifest.split():
        value, _, length = run.partition("x")
        samples += [int(value)] * int(length or 1)
    return samples


def write_picture(path: Path, values: npt.NDArray[Any], **attributes: Any) -> Path:
    """Whole numbers of 8 or 16 bits, or floats, of shape (height, width, channels), as they are.

    Of four channels the last is alpha, and of two. Attributes are OpenImageIO's.
    """
    height, width, channels = values.shape
    kinds = {"uint8": oiio.UINT8, "uint16": oiio.UINT16, "float32": oiio.FLOAT}
    spec = oiio.ImageSpec(width, height, channels, kinds[values.dtype.name])
    spec.attribute("oiio:UnassociatedAlpha", 1)
    for name, value in attributes.items():
        spec.attribute(name.replace("__", ":"), value)
    output = oiio.ImageOutput.create(str(path))
    assert output is not None
    assert output.open(str(path), spec)
    assert output.write_image(np.ascontiguousarray(values))
    output.close()
    return path


def read_pixels(path: Path) -> npt.NDArray[np.float32]:
    """All channels of a picture, shape (height, width, channels)."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)
    return np.atleast_3d(np.asarray(pixels, dtype=np.float32))
