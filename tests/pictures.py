"""Writes small OpenEXR files."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation


def write_exr(path: Path, values: npt.NDArray[np.floating], names: str = "XYZ") -> Path:
    """Values of shape (height, width, channels), a channel for each letter of `names`."""
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], oiio.FLOAT)
    spec.channelnames = tuple(names)
    output = oiio.ImageOutput.create(str(path))
    assert output is not None
    assert output.open(str(path), spec)
    output.write_image(np.ascontiguousarray(values, dtype=np.float32))
    output.close()
    return path
