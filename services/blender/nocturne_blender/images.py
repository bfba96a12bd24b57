"""Images of Blender as files that a document can name."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .files import Files, exr, png
from .findings import Findings

Json = Any

# By Image.file_format: what OpenImageIO reads from files as they are.
_AS_THEY_ARE = ("PNG", "JPEG", "OPEN_EXR", "HDR", "TIFF", "BMP", "TARGA", "WEBP")
_WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp"}


class Images:
    """Each image once."""

    def __init__(self, files: Files, findings: Findings) -> None:
        self._files = files
        self._findings = findings
        self._assets: dict[tuple[str, bool], str] = {}

    def texture(self, node: Any, *, colour: bool, alpha: bool) -> Json | None:
        """A Texture of an Image Texture node's colours or opacity; None where there is no image."""
        image = node.image
        if image is None or (not image.has_data and not image.size[0]):
            self._findings.lost(node.name, "has no image")
            return None
        if node.projection != "FLAT":
            self._findings.lost(image.name, f"no support for the projection {node.projection}; taken as flat")
        wrap = _WRAPS.get(node.extension)
        if wrap is None:
            self._findings.lost(
                image.name, f"no support for the extension {node.extension}; the image is repeated"
            )
            wrap = "repeat"
        if alpha:
            return {"asset": self._files.add(_opacity(image)), "encoding": "linear", "wrap": wrap}
        encoding = "sRGB" if image.colorspace_settings.name == "sRGB" and not image.is_float else "linear"
        if not colour and encoding == "sRGB":
            self._findings.lost(image.name, "holds numbers and not colours, but is not Non-Color")
        made = {"asset": self._asset(image, floats=False), "encoding": encoding, "wrap": wrap}
        return made | ({"sharp": True} if node.interpolation == "Closest" else {})

    def sky(self, image: Any) -> str:
        """An HDR or EXR file."""
        return self._asset(image, floats=True)

    def _asset(self, image: Any, *, floats: bool) -> str:
        key = (image.name_full, floats)
        if key not in self._assets:
            self._assets[key] = self._files.add(_content(image, floats=floats))
        return self._assets[key]


def _content(image: Any, *, floats: bool) -> bytes:
    """The file that an image came from, or else a file of its pixels."""
    kept = ("OPEN_EXR", "HDR") if floats else _AS_THEY_ARE
    if image.source == "FILE" and not image.is_dirty and image.file_format in kept:
        if image.packed_file is not None:
            return bytes(image.packed_file.data)
        path = Path(bpy.path.abspath(image.filepath, library=image.library))
        if path.is_file():
            return path.read_bytes()
    pixels = _pixels(image)
    if image.channels < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=2)
    if floats and not image.is_float and image.colorspace_settings.name == "sRGB":
        pixels = np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)
    if floats or image.is_float:
        return exr(pixels[..., :3])
    # Pixels of byte images are as stored, not yet linear.
    return png(np.rint(np.clip(pixels, 0, 1) * 255).astype(np.uint8))


def _opacity(image: Any) -> bytes:
    """A file of an image's fourth channel; white where it has none."""
    pixels = _pixels(image)
    alpha = pixels[..., 3:4] if image.channels == 4 else np.ones_like(pixels[..., :1])
    return png(np.rint(np.clip(alpha, 0, 1) * 255).astype(np.uint8))


def _pixels(image: Any) -> Any:
    """Of an image, the top row first."""
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, image.channels)[::-1]
