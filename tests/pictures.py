"""Small OpenEXR files, and what one of ours says of itself."""

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


def samples_of(manifest: str) -> list[int]:
    """The samples of each tile, from the attribute `nocturne:tileSamples`: "64x3 128 64"."""
    samples: list[int] = []
    for run in manifest.split():
        value, _, length = run.partition("x")
        samples += [int(value)] * int(length or 1)
    return samples
