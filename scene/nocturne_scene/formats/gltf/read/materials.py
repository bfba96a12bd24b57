"""Metallic-roughness materials and their extensions, as kernels."""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, floats, number, unused_extensions, value
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.coats import smooth_coat
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.textures.environment_maps import UnusableImageError, check_size, opened
from nocturne_scene.textures.image_files import MAX_EDGE, MAX_PIXELS, decoded

_KNOWN = (
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
)
_WRAPS = {10497: "repeat", 33071: "clamp"}

# Fraunhofer's lines F, d and C, um, which Abbe's number is of.
_F, _D, _C = 0.4861, 0.5876, 0.6563


@dataclass
class Materials:
    """The materials of one file."""

    container: Container
    writer: SceneWriter
    findings: Findings
    _made: dict[int | None, tuple[Json, Json]] = field(default_factory=dict)
    _pixels: dict[int, NDArray[np.float64]] = field(default_factory=dict)

    def surface(self, index: Json) -> Json:
        """The fields of a surface of a material: kernel, luminaire, normal map."""
        if index not in self._made:
            entry = {} if index is None else self.container.item("materials", index, "a primitive")
            self._made[index] = self._make(entry, f"materials[{index}]", entry.get("name") or "material")
        kernel, rest = self._made[index]
        return {"kernel": kernel, **rest}

    def _make(self, entry: Json, place: str, name: str) -> tuple[Json, Json]:
        shown = self.container.at(place)
        unused_extensions(entry, _KNOWN, self.findings, shown)
        extensions = value(entry, "extensions", {})
        pbr = value(entry, "pbrMetallicRoughness", {})
        kernel = self._transmitting(self._opaque(pbr, extensions, place), pbr, extensions, place)
        kernel = self._masked(kernel, entry, pbr, place)
        if not value(entry, "doubleSided", False):
            self.findings.note("", "surfaces that glTF shows from the front only are there from behind too")
        rest: Json = {}
        if "normalTexture" in entry:
            if number(self.container, entry["normalTexture"], "scale", 1.0, place) != 1.0:
                self.findings.lost(shown, "no equal of a normal map's scale")
            asset, use = self._picture(entry["normalTexture"], place)
            rest["normal_map"] = {**use, "texture": {**use["texture"], "asset": asset, "encoding": "linear"}}
        if "occlusionTexture" in entry:
            self.findings.note(shown, "the occlusion texture is left out: light finds out what is in its way")
        luminaire = self._emission(entry, extensions, place)
        if luminaire is not None:
            rest["luminaire"] = luminaire
        return self.writer.name("kernels", str(name), kernel), rest

    def _index(self, extensions: Json, place: str) -> float:
        ior = number(self.container, value(extensions, "KHR_materials_ior", {}), "ior", 1.5, place)
        if not 1 <= ior <= 100:
            raise InputError.at(
                self.container.at(place), f"an index of refraction is 1 or more, found {ior:g}"
            )
        return ior

    def _opaque(self, pbr: Json, extensions: Json, place: str) -> Json:
        factor = np.clip(floats(self.container, pbr, "baseColorFactor", [1.0] * 4, place)[:3], 0.0, 1.0)
        metal_colour = factor
        # What light that went through the coat comes out with, not what is under it.
        index = self._index(extensions, place)
        coat = smooth_coat(index)
        base: Json = colours.reflectance(coat.changed(factor, linear=True).tolist())
        if "baseColorTexture" in pbr:
            pixels = factor * decoded(self._read(pbr["baseColorTexture"], place)[..., :3])
            metal_colour = pixels.mean(axis=(0, 1))
            _, use = self._picture(pbr["baseColorTexture"], place)
            base = self._baked(use, coat.changed(pixels, linear=True), "base")
        metallic: Json = number(self.container, pbr, "metallicFactor", 1.0, place)
        rough = number(self.container, pbr, "roughnessFactor", 1.0, place)
        alpha: Json = rough**2
        if "metallicRoughnessTexture" in pbr:
            pixels = self._read(pbr["metallicRoughnessTexture"], place)
            _, use = self._picture(pbr["metallicRoughnessTexture"], place)
            alpha = self._baked(use, (rough * pixels[..., 1:2]) ** 2, "roughness")
            metallic = self._baked(use, metallic * pixels[..., 2:3], "metallic")
        roughness = {} if alpha == 0.0 else {"roughness": alpha}
        plastic = {
            "type": "coated_diffuse",
            "index": index,
            "reflectance": base,
            **roughness,
        }
        if metallic == 0.0:
            return plastic
        if "baseColorTexture" in pbr and metallic != 0.0:
            self.findings.note(
                self.container.at(place), "where it is metal the base colour's texture counts by its mean"
            )
        metal = {
            "type": "conductor",
            "index": metals.of_colour(colours.reflectance(metal_colour.tolist())),
            **roughness,
        }
        if metallic == 1.0:
            return metal
        return {"type": "blend", "first": plastic, "second": metal, "weight": metallic}

    def _transmitting(self, opaque: Json, pbr: Json, extensions: Json, place: str) -> Json:
        transmission = value(extensions, "KHR_materials_transmission", None)
        if transmission is None:
            return opaque
        factor = number(self.container, transmission, "transmissionFactor", 0.0, place)
        if "transmissionTexture" in transmission:
            pixels = self._read(transmission["transmissionTexture"], place)
            _, use = self._picture(transmission["transmissionTexture"], place)
            weight: Json = self._baked(use, factor * pixels[..., 0:1], "transmission")
        else:
            weight = factor
        volume = value(extensions, "KHR_materials_volume", {})
        rough = number(self.container, pbr, "roughnessFactor", 1.0, place)
        if number(self.container, volume, "thicknessFactor", 0.0, place) > 0:
            glass: Json = {"type": "dielectric", "index": self._dispersive(extensions, place)}
            if rough > 0:
                glass["roughness"] = rough**2
            glass |= self._absorption(volume, place)
        else:
            glass = {"type": "thin_pane", "index": self._index(extensions, place)}
            tint = [
                min(1.0, part)
                for part in floats(self.container, pbr, "baseColorFactor", [1.0] * 4, place)[:3]
            ]
            if tint != [1.0, 1.0, 1.0]:
                glass["transmittance"] = colours.reflectance(tint)
            if rough > 0:
                self.findings.lost(self.container.at(place), "no equal of a thin sheet that is rough")
        if weight == 0.0:
            return opaque
        return (
            glass if weight == 1.0 else {"type": "blend", "first": opaque, "second": glass, "weight": weight}
        )

    def _dispersive(self, extensions: Json, place: str) -> Json:
        """n = A + B / l^2 with the index at d, and Abbe's number 20 / dispersion."""
        index = self._index(extensions, place)
        dispersion = value(extensions, "KHR_materials_dispersion", {})
        strength = number(self.container, dispersion, "dispersion", 0.0, place)
        if not strength > 0:
            return index
        b = (index - 1) * strength / 20 / (1 / _F**2 - 1 / _C**2)
        return {"cauchy": [index - b / _D**2, b]}

    def _absorption(self, volume: Json, place: str) -> Json:
        """After the attenuation distance light has the attenuation colour."""
        distance = value(volume, "attenuationDistance", None)
        colour = floats(self.container, volume, "attenuationColor", [1.0] * 3, place)
        if distance is None or min(colour) >= 1.0:
            return {}
        if not number(self.container, volume, "attenuationDistance", 1.0, place) > 0:
            raise InputError.at(self.container.at(place), "the attenuation distance is more than 0")
        at = np.arange(360.0, 831.0, 5.0)
        values = rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(np.array(colour)), at)
        coefficients = -np.log(np.maximum(values, 1e-6)) / float(distance)
        return {"absorption": {"table": np.stack([at, coefficients], 1).tolist()}}

    def _masked(self, kernel: Json, entry: Json, pbr: Json, place: str) -> Json:
        mode = value(entry, "alphaMode", "OPAQUE")
        if mode == "OPAQUE":
            return kernel
        factor = floats(self.container, pbr, "baseColorFactor", [1.0] * 4, place)[3]
        cutoff = number(self.container, entry, "alphaCutoff", 0.5, place)
        opacity: Json = factor if mode == "BLEND" else float(factor >= cutoff)
        if "baseColorTexture" in pbr:
            pixels = self._read(pbr["baseColorTexture"], place)
            if pixels.shape[2] == 4:
                alpha = factor * pixels[..., 3:4]
                _, use = self._picture(pbr["baseColorTexture"], place)
                opacity = self._baked(
                    use, alpha if mode == "BLEND" else (alpha >= cutoff).astype(float), "opacity"
                )
        return kernel if opacity == 1.0 else {"type": "mask", "kernel": kernel, "opacity": opacity}

    def _emission(self, entry: Json, extensions: Json, place: str) -> Json | None:
        factor = floats(self.container, entry, "emissiveFactor", [0.0] * 3, place)
        strength = value(extensions, "KHR_materials_emissive_strength", {})
        luminance = number(self.container, strength, "emissiveStrength", 1.0, place)
        if not max(factor) > 0:
            return None
        radiance = colours.light(factor, luminance)
        if "emissiveTexture" in entry:
            asset, use = self._picture(entry["emissiveTexture"], place)
            texture = {**use["texture"], "asset": asset, "encoding": "sRGB"}
            radiance = {**use, "texture": texture, "spectrum": radiance}
        return {"radiance": radiance}

    def _picture(self, reference: Json, place: str) -> tuple[str, Json]:
        """The file of a texture, and the fields of its use."""
        texture = self.container.item("textures", value(reference, "index", None), place)
        if value(reference, "texCoord", 0) != 0:
            self.findings.lost(self.container.at(place), "no equal of a second set of texture coordinates")
        index = texture.get("source")
        content, end = self.container.image(index, place)
        name = f"textures/image-{index}{end}"
        if not (self.writer.folder / name).exists():
            (self.writer.folder / "textures").mkdir(exist_ok=True)
            self.writer.file(name, content)
        sampler = self.container.item("samplers", texture["sampler"], place) if "sampler" in texture else {}
        wraps = {sampler.get("wrapS", 10497), sampler.get("wrapT", 10497)}
        if len(wraps) > 1 or not wraps <= set(_WRAPS):
            self.findings.lost(self.container.at(place), "no equal of its wrap modes; taken as repeat")
        wrap = _WRAPS.get(next(iter(wraps)), "repeat")
        transform = value(value(reference, "extensions", {}), "KHR_texture_transform", {})
        unused_extensions(reference, ("KHR_texture_transform",), self.findings, self.container.at(place))
        if number(self.container, transform, "rotation", 0.0, place) != 0.0:
            self.findings.lost(self.container.at(place), "texture coordinates that are turned have no equal")
        scale = floats(self.container, transform, "scale", [1.0, 1.0], place)
        offset = floats(self.container, transform, "offset", [0.0, 0.0], place)
        use: Json = {"texture": {"wrap": wrap}}
        if scale != [1.0, 1.0] or offset != [0.0, 0.0]:
            use |= {"scale": scale, "offset": [offset[0], 1.0 - scale[1] - offset[1]]}
        return name, use

    def _read(self, reference: Json, place: str) -> NDArray[np.float64]:
        """Pixels as stored, in [0, 1]; at least three channels."""
        texture = self.container.item("textures", value(reference, "index", None), place)
        index = int(texture.get("source") or 0)
        if index not in self._pixels:
            content, end = self.container.image(index, place)
            with tempfile.TemporaryDirectory() as folder:
                file = Path(folder) / f"image{end}"
                file.write_bytes(content)
                self._pixels[index] = self._decoded(file, place)
        return self._pixels[index]

    def _decoded(self, file: Path, place: str) -> NDArray[np.float64]:
        try:
            with opened(file) as picture:
                check_size(picture.spec(), MAX_PIXELS, MAX_EDGE)
                read = picture.read_image(oiio.FLOAT)
        except UnusableImageError as error:
            raise InputError.at(self.container.at(place), str(error)) from None
        if read is None:
            raise InputError.at(self.container.at(place), "the image can't be read")
        pixels = np.atleast_3d(np.asarray(read, dtype=np.float64))
        return pixels if pixels.shape[2] >= 3 else np.repeat(pixels[..., :1], 3, axis=2)

    def _baked(self, use: Json, pixels: NDArray[np.float64], name: str) -> Json:
        """A scalar texture of pixels in place of a use's own."""
        asset = self.writer.picture(name, pixels)
        return {**use, "texture": {**use["texture"], "asset": asset, "encoding": "linear"}}
