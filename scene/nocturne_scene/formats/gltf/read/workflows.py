"""What light meets first: base colour, metal and roughness, however a material says them."""

from dataclasses import dataclass

import numpy as np

from nocturne_scene.formats.gltf.read.container import Container, floats, number, value
from nocturne_scene.formats.gltf.read.coordinates import Frame
from nocturne_scene.formats.gltf.read.pictures import Pictures, Pixels
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra.published import SRGB_LUMINANCE
from nocturne_scene.textures.image_files import decoded

# Reflectance of glass at normal incidence, which metallic-roughness materials have where they are no metal.
_GLASS = 0.04


@dataclass
class Workflow:
    """The parameters of a metallic-roughness material."""

    base: Pixels
    """Linear red, green, blue, alpha: shape (4,), or that of a picture."""
    base_use: Json
    """How a picture of it is looked up."""
    metallic: float | Pixels
    rough: float | Pixels
    """Pictures have the shape (rows, columns, 1)."""
    rough_use: Json
    base_texture: Json = None
    """The texture that holds the base's colours as they are, so that no other picture is needed."""


def metallic_roughness(
    container: Container, pictures: Pictures, pbr: Json, frame: Frame, place: str
) -> Workflow:
    """Of the core's materials."""
    base: Pixels = np.clip(floats(container, pbr, "baseColorFactor", [1.0] * 4, place), 0.0, 1.0)
    base_use: Json = {}
    plain: Json = None
    if "baseColorTexture" in pbr:
        if np.all(base[:3] == 1.0):
            plain = pbr["baseColorTexture"]
        base = base * _linear(pictures.pixels(pbr["baseColorTexture"], place))
        base_use = pictures.use(pbr["baseColorTexture"], frame, place)
    metallic: float | Pixels = number(container, pbr, "metallicFactor", 1.0, place)
    rough: float | Pixels = number(container, pbr, "roughnessFactor", 1.0, place)
    rough_use: Json = {}
    if "metallicRoughnessTexture" in pbr:
        pixels = pictures.pixels(pbr["metallicRoughnessTexture"], place)
        rough_use = pictures.use(pbr["metallicRoughnessTexture"], frame, place)
        rough, metallic = rough * pixels[..., 1:2], metallic * pixels[..., 2:3]
    return Workflow(base, base_use, metallic, rough, rough_use, plain)


def specular_glossiness(
    container: Container, pictures: Pictures, entry: Json, frame: Frame, place: str
) -> Workflow:
    """Of KHR_materials_pbrSpecularGlossiness, as metal and glass of the same diffuse and specular colour.

    Both workflows are a diffuse part and one reflectance F0 at normal incidence: with metal m and base
    colour c the diffuse colour is (1 - m) c and F0 is 0.04 (1 - m) + m c. These two are solved for m, of
    brightness, and c. An F0 below 0.04 becomes 0.04.
    """
    diffuse: Pixels = np.clip(floats(container, entry, "diffuseFactor", [1.0] * 4, place), 0.0, 1.0)
    specular: Pixels = np.clip(floats(container, entry, "specularFactor", [1.0] * 3, place), 0.0, 1.0)
    glossy: float | Pixels = number(container, entry, "glossinessFactor", 1.0, place)
    use: Json = {}
    if "diffuseTexture" in entry:
        diffuse = diffuse * _linear(pictures.pixels(entry["diffuseTexture"], place))
        use = pictures.use(entry["diffuseTexture"], frame, place)
    if "specularGlossinessTexture" in entry:
        pixels = pictures.pixels(entry["specularGlossinessTexture"], place)
        other = pictures.use(entry["specularGlossinessTexture"], frame, place)
        if use and other != use:
            pictures.findings.lost(
                container.at(place), "no support for diffuse and specular textures in different places"
            )
        use = other
        specular = specular * decoded(pixels[..., :3])
        if pixels.shape[2] == 4:
            glossy = glossy * pixels[..., 3:4]
        if diffuse.ndim == 3:
            diffuse = resized(diffuse, pixels.shape[0], pixels.shape[1])
    elif diffuse.ndim == 3:
        specular = np.broadcast_to(specular, (*diffuse.shape[:2], 3))
    if diffuse.ndim < specular.ndim:
        diffuse = np.broadcast_to(diffuse, (*specular.shape[:2], 4))
    metallic, base = _solved(diffuse[..., :3], specular)
    whole = np.concatenate([base, diffuse[..., 3:4]], axis=-1)
    rough = 1 - glossy
    if whole.ndim == 1:
        return Workflow(whole, {}, float(metallic[0]), rough, {})
    return Workflow(whole, use, metallic, rough, use)


def _solved(diffuse: Pixels, specular: Pixels) -> tuple[Pixels, Pixels]:
    """Metal and base colour, of a last axis of 1 and of 3.

    Light that glossiness reflects does not reach the diffuse part: it is 1 - max(F0) of its colour.
    """
    below = diffuse * (1 - specular.max(axis=-1, keepdims=True))
    d, s = ((each @ SRGB_LUMINANCE)[..., None] for each in (below / (1 - _GLASS), specular))
    # d = (1 - m) c and s = g (1 - m) + m c, so g m^2 + (d + s - 2 g) m + g - s = 0.
    b, c = d + s - 2 * _GLASS, _GLASS - s
    root = np.sqrt(np.maximum(b**2 - 4 * _GLASS * c, 0.0))
    metallic = np.where(s <= _GLASS, 0.0, np.clip((root - b) / (2 * _GLASS), 0.0, 1.0))
    of_diffuse = below / (1 - _GLASS) / np.maximum(1 - metallic, 1e-6)
    of_specular = (specular - _GLASS * (1 - metallic)) / np.maximum(metallic, 1e-6)
    part = metallic**2
    return metallic, np.clip((1 - part) * of_diffuse + part * of_specular, 0.0, 1.0)


def _linear(pixels: Pixels) -> Pixels:
    """Four channels, alpha as it is."""
    alpha = pixels[..., 3:4] if pixels.shape[2] == 4 else np.ones((*pixels.shape[:2], 1))
    return np.concatenate([decoded(pixels[..., :3]).astype(np.float64), alpha], axis=2)


def resized(pixels: Pixels, rows: int, columns: int) -> Pixels:
    """The nearest pixels of another number of rows and columns."""
    row = (np.arange(rows) * pixels.shape[0]) // rows
    column = (np.arange(columns) * pixels.shape[1]) // columns
    return np.asarray(pixels[row][:, column])


def is_lit(entry: Json) -> bool:
    """Whether light falls on a material; else it is seen as it is."""
    return "KHR_materials_unlit" not in value(entry, "extensions", {})
