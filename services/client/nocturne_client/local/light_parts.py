"""`nocturne light-parts`: direct and indirect light of an image as layers of one EXR file.

The direct part is an image of its own, with one interaction at most; all other light is what the whole image
has more. Their sum is the image in every pixel, and the error of the indirect part is that of both.
"""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.compare.images import Picture, read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.textures.image_files import NO_DATE
from numpy.typing import NDArray

from nocturne_client.errors import NocturneClientError, Problem
from nocturne_client.preview.colour import linear_srgb


def write_light_parts(image: Path, direct: Path, output: Path) -> str:
    """Writes the layers `direct` and `indirect`: linear sRGB, Y, and Y's standard error where both files tell
    theirs. Gives what their means are, in words. Raises NocturneClientError."""
    try:
        whole, part = read_picture(image), read_picture(direct)
        if whole.xyz.shape != part.xyz.shape:
            raise InputError.at(str(direct), f"has not the film of {image}")
    except InputError as error:
        problems = [Problem(each.place, each.message) for each in error.problems]
        raise NocturneClientError("the images do not belong together", problems=problems) from error
    channels = _channels(whole, part)
    _write(output, channels)
    mean, straight = (float(each.xyz[..., 1].mean()) for each in (whole, part))
    share = straight / mean if mean > 0.0 else 0.0
    return f"mean Y {mean:.5g}: {straight:.5g} direct ({share:.1%}), {mean - straight:.5g} indirect"


def _channels(whole: Picture, part: Picture) -> dict[str, NDArray[Any]]:
    found: dict[str, NDArray[Any]] = {}
    for layer, xyz in (("direct", part.xyz), ("indirect", whole.xyz - part.xyz)):
        rgb = linear_srgb(xyz.astype(np.float32))
        found |= {f"{layer}.{name}": rgb[..., index] for index, name in enumerate("RGB")}
        found[f"{layer}.Y"] = xyz[..., 1]
    if whole.y_error is not None and part.y_error is not None:
        found["direct.Y.stderr"] = part.y_error
        found["indirect.Y.stderr"] = np.hypot(whole.y_error, part.y_error)
    return found


def _write(path: Path, channels: dict[str, NDArray[Any]]) -> None:
    height, width = next(iter(channels.values())).shape
    spec = oiio.ImageSpec(width, height, len(channels), oiio.FLOAT)
    spec.channelnames = list(channels)
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", NO_DATE)
    pixels = np.stack([each.astype(np.float32) for each in channels.values()], axis=-1)
    file = oiio.ImageOutput.create("exr")
    if file is None or not (file.open(str(path), spec) and file.write_image(pixels) and file.close()):
        raise NocturneClientError(f"can't write {path}: {oiio.geterror()}")
