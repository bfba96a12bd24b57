"""Layers of an image: what the surfaces that its pixels see are like, where they are and which they are.

They are made once for a render, by `compile.layers`, kept as a separate EXR file, and written with
the image's channels whenever an image is written.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

from nocturne_scene.errors import InputError
from nocturne_scene.library_words import said_by

CHANNELS: dict[str, tuple[str, ...]] = {
    "albedo": ("albedo.R", "albedo.G", "albedo.B"),
    "normal": ("N.X", "N.Y", "N.Z"),
    "depth": ("depth.Z",),
    "position": ("P.X", "P.Y", "P.Z"),
    "object": ("id.object",),
    "material": ("id.material",),
    "emission": ("emission.part",),
}
"""By the name of a layer, in the order of PixelLayers in worker/src/tracer/layers.h; spelled as Nuke, Blender
and tev group them."""

OBJECTS = "nocturne:objects"
"""An EXR attribute: names of surfaces, the first of which is object 1, as JSON."""

_NO_DATE = "1970:01:01 00:00:00"
"""Equal layers are equal files."""

Values = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Layers:
    """Channels by name, each of shape (height, width), and attributes of files that have them."""

    channels: Mapping[str, Values] = field(default_factory=dict)
    attributes: Mapping[str, str] = field(default_factory=dict)


NO_LAYERS = Layers()


def known_layers(names: Iterable[str]) -> tuple[str, ...]:
    """The same layers in one order, each once. Raises InputError for names that there are not."""
    asked = set(names)
    wrong = sorted(asked - CHANNELS.keys())
    if wrong:
        raise InputError.at("$.layers", f"there is no {wrong[0][:40]!r}; expected {', '.join(CHANNELS)}")
    return tuple(name for name in CHANNELS if name in asked)


def write_layers(path: Path, names: Sequence[str], values: Values, objects: str) -> None:
    """Writes those layers of pixels of shape (height, width, 13). Raises OSError."""
    every = [channel for channels in CHANNELS.values() for channel in channels]
    wanted = [channel for name in names for channel in CHANNELS[name]]
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], len(wanted), oiio.FLOAT)
    spec.channelnames = wanted
    spec.attribute("compression", "zip")
    spec.attribute(OBJECTS, objects)
    # Else the library writes that of now, and equal layers would not be equal files.
    spec.attribute("DateTime", _NO_DATE)
    pixels = np.ascontiguousarray(values[..., [every.index(channel) for channel in wanted]])
    output = oiio.ImageOutput.create("exr")
    if output is None or not (output.open(str(path), spec) and output.write_image(pixels) and output.close()):
        raise OSError(f"can't write {path}: {said_by(oiio.geterror)}")


def read_layers(path: Path) -> Layers:
    """What `write_layers` wrote. Raises OSError."""
    picture = oiio.ImageInput.open(str(path))
    if picture is None:
        raise OSError(f"can't read {path}: {said_by(oiio.geterror)}")
    try:
        spec = picture.spec()
        pixels = picture.read_image(oiio.FLOAT)
        if pixels is None:
            raise OSError(f"can't read {path}: {said_by(picture.geterror)}")
        names = [str(name) for name in spec.channelnames]
        channels = {name: np.ascontiguousarray(pixels[..., i]) for i, name in enumerate(names)}
        return Layers(channels, {OBJECTS: spec.get_string_attribute(OBJECTS)})
    finally:
        picture.close()
