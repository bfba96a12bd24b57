"""Documents whose textures and environment are means."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.library_words import said_by
from nocturne_scene.simplify.simplification import Document, Find, Simplification, objects
from nocturne_scene.spectra.published import SRGB_LUMINANCE
from nocturne_scene.textures.image_files import MAX_EDGE, MAX_PIXELS, decoded
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

Array = NDArray[np.float64]

_COLOURS = ("reflectance", "transmittance", "radiance", "base", "specular_colour", "sheen")
_SCALARS = (
    *("roughness", "roughness_u", "roughness_v", "roughness_across", "rotation", "weight", "opacity"),
    *("metallic", "specular", "coat", "coat_roughness", "sheen_roughness"),
)
_MAPS = ("normal_map", "bump_map")


def pictures(document: Document, find: Find) -> Iterator[Simplification]:
    """Textures by their means, surfaces without maps of normals and heights, a constant environment."""
    uses = [key for each in objects(document) for key, value in each.items() if _is_use(value)]
    if any(key in (*_COLOURS, *_SCALARS) for key in uses):
        yield Simplification("textures by their means", partial(_mean_textures, find))
    if any(key in _MAPS for key in uses):
        yield Simplification("without maps of normals and heights", _drop_maps)
    if "asset" in (document.get("environment") or {}):
        yield Simplification("the environment by its mean", partial(_mean_environment, find))


def _is_use(value: Any) -> bool:
    return isinstance(value, dict) and "texture" in value


def _drop_maps(document: Document) -> None:
    for each in objects(document):
        for key in _MAPS:
            if _is_use(each.get(key)):
                del each[key]


def _mean_textures(find: Find, document: Document) -> None:
    for each in objects(document):
        for key, value in list(each.items()):
            if key in (*_COLOURS, *_SCALARS) and _is_use(value):
                mean = _mean_of_scalar if key in _SCALARS else _mean_of_colour
                each[key] = mean(value, document, find)


class _Texels(NamedTuple):
    """Linear values, shape (height, width, 1 or 3)."""

    values: Array

    @property
    def grey(self) -> Array:
        """Luminance, or the only channel; shape (height, width)."""
        luminance: Array = self.values @ SRGB_LUMINANCE if self.values.shape[2] == 3 else self.values[..., 0]
        return luminance


def _texels(use: Document, document: Document, find: Find, encoding: str | None) -> _Texels:
    """`encoding` None: as fits a colour in this file, as the compiler has it."""
    texture = use["texture"]
    if isinstance(texture, str):
        texture = document["textures"][texture]
    values, is_float = _read(find(texture["asset"]))
    encoding = texture.get("encoding") or encoding or ("linear" if is_float else "sRGB")
    return _Texels(decoded(values).astype(np.float64) if encoding == "sRGB" else values)


def _mean_of_scalar(use: Document, document: Document, find: Find) -> float:
    texels = _texels(use, document, find, "linear").grey
    return float(np.mean(np.clip(use.get("gain", 1.0) * texels + use.get("bias", 0.0), 0.0, 1.0)))


def _mean_of_colour(use: Document, document: Document, find: Find) -> Any:
    """A spectrum; a texture where no spectrum has the same mean: colours times a spectrum that is not 1."""
    texels = _texels(use, document, find, None)
    spectrum = use.get("spectrum", 1.0)
    if isinstance(spectrum, str):
        spectrum = document["spectra"][spectrum]
    if isinstance(spectrum, int | float):
        spectrum = {"constant": spectrum}
    if use.get("grey", False) or texels.values.shape[2] == 1:
        mean = float(texels.grey.mean())
        for size in ("luminance", "constant"):
            if spectrum.get(size) is not None:
                return {**spectrum, size: mean * spectrum[size]}
        return use
    if spectrum != {"constant": 1.0}:
        return use
    return {"rgb": np.clip(texels.values.mean(axis=(0, 1)), 0.0, 1.0).round(6).tolist()}


def _mean_environment(find: Find, document: Document) -> None:
    """Over solid angle: rows of a latitude-longitude map weigh as the sine of their polar angle."""
    environment = document.get("environment") or {}
    if "asset" not in environment:
        return
    values, _ = _read(find(environment["asset"]))
    if values.shape[2] == 1:
        values = np.repeat(values, 3, axis=2)
    edges = np.cos(np.pi * np.arange(values.shape[0] + 1) / values.shape[0])
    mean = np.average(np.maximum(values, 0.0).mean(axis=1), axis=0, weights=-np.diff(edges))
    luminance = environment.get("luminance", 1.0) * float(mean @ SRGB_LUMINANCE)
    if luminance > 0:
        rgb = (mean / mean.max()).round(6).tolist()
        document["environment"] = {"radiance": {"rgb": rgb, "luminance": luminance}}


def _read(file: Path) -> tuple[Array, bool]:
    """Pixels as stored, shape (height, width, 1 or 3), and whether they are floating-point numbers."""
    with opened(file) as picture:
        spec = picture.spec()
        check_size(spec, MAX_PIXELS, MAX_EDGE)
        channels = 3 if spec.nchannels >= 3 else 1
        pixels = picture.read_image(0, 0, 0, channels, oiio.FLOAT)
        if pixels is None:
            raise UnusableImageError(f"the picture can't be read: {said_by(picture.geterror)}")
        is_float = spec.format.basetype in (oiio.HALF, oiio.FLOAT)
        return np.asarray(pixels, dtype=np.float64).reshape(spec.height, spec.width, channels), is_float
