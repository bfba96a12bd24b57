"""Materials of glTF and their extensions, as kernels.

One file, though long: extensions change what the parts before them found, in the order of the specification.
"""

from dataclasses import dataclass, field

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.container import Container, floats, number, unused_extensions, value
from nocturne_scene.formats.gltf.read.coordinates import Frame, frame_of
from nocturne_scene.formats.gltf.read.emission import emission, opacity, unlit
from nocturne_scene.formats.gltf.read.pictures import Pictures, Pixels
from nocturne_scene.formats.gltf.read.workflows import (
    Workflow,
    is_lit,
    metallic_roughness,
    specular_glossiness,
)
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.baking import LOOKUP
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.textures.image_files import decoded

KNOWN = (
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
)
"""Extensions of materials that are read."""

# Fraunhofer's lines F, d and C, um, which Abbe's number is of.
_F, _D, _C = 0.4861, 0.5876, 0.6563


@dataclass
class Materials:
    """The materials of one file."""

    container: Container
    writer: SceneWriter
    findings: Findings
    pictures: Pictures
    _made: dict[tuple[int | None, tuple[float, ...]], tuple[Json, Json]] = field(default_factory=dict)
    _frames: dict[int | None, Frame] = field(default_factory=dict)

    def frame(self, index: Json) -> Frame:
        """The texture coordinates that a mesh of a material needs."""
        # Which also tells whether there is one.
        entry = self._entry(index)
        if index not in self._frames:
            self._frames[index] = frame_of(self.container, entry, f"materials[{index}]")
        return self._frames[index]

    def is_textured(self, index: Json) -> bool:
        """Whether a mesh of a material needs texture coordinates."""
        return "Texture" in str(self._entry(index))

    def surface(self, index: Json, tint: Pixels | None) -> Json:
        """The fields of a surface of a material: kernel, luminaire, normal map.

        `tint`: what its base colour is multiplied with, linear red, green, blue, alpha; or a picture of that
        on the mesh's own coordinates.
        """
        name = str(self._entry(index).get("name") or "material")
        if tint is not None and tint.ndim == 3:
            kernel, rest = self._make(index, tint, name)
            return {"kernel": kernel, **rest}
        key = (index, () if tint is None else tuple(tint.tolist()))
        if key not in self._made:
            self._made[key] = self._make(index, tint, name)
        kernel, rest = self._made[key]
        return {"kernel": kernel, **rest}

    def _entry(self, index: Json) -> Json:
        return {} if index is None else self.container.item("materials", index, "a primitive")

    def _make(self, index: Json, tint: Pixels | None, name: str) -> tuple[Json, Json]:
        entry, place, frame = self._entry(index), f"materials[{index}]", self.frame(index)
        shown = self.container.at(place)
        unused_extensions(entry, KNOWN, self.findings, shown)
        extensions = value(entry, "extensions", {})
        pbr = value(entry, "pbrMetallicRoughness", {})
        workflow = self._workflow(pbr, extensions, frame, tint, place)
        if not value(entry, "doubleSided", False):
            self.findings.note("", "surfaces that glTF shows from the front only are there from behind too")
        rest: Json = {}
        if "normalTexture" in entry:
            if number(self.container, entry["normalTexture"], "scale", 1.0, place) != 1.0:
                self.findings.lost(shown, "no support for a normal map's scale")
            use = self.pictures.use(entry["normalTexture"], frame, place)
            rest["normal_map"] = self.pictures.whole(use, entry["normalTexture"], "linear", place)
        if "occlusionTexture" in entry:
            self.findings.note(shown, "the occlusion texture is left out: light finds out what is in its way")
        shown_part = opacity(self.container, entry, workflow, place)
        if is_lit(entry):
            opaque = self._opaque(workflow, extensions, frame, place)
            kernel = self._transmitting(opaque, workflow, extensions, frame, place)
            radiance = emission(self.pictures, entry, workflow, shown_part, frame, place)
            is_two_sided = value(entry, "doubleSided", False)
        else:
            kernel = {"type": "lambertian", "reflectance": 0.0}
            radiance = unlit(self.pictures, workflow, shown_part, place)
            is_two_sided = True
        if radiance is not None:
            rest["luminaire"] = {"radiance": radiance} | ({"two_sided": True} if is_two_sided else {})
        if not isinstance(shown_part, float):
            part = self.pictures.baked(workflow.base_use, shown_part, "opacity")
            kernel = {"type": "mask", "kernel": kernel, "opacity": part}
        elif shown_part != 1.0:
            kernel = {"type": "mask", "kernel": kernel, "opacity": shown_part}
        return self.writer.name("kernels", name, kernel), rest

    def _workflow(
        self, pbr: Json, extensions: Json, frame: Frame, tint: Pixels | None, place: str
    ) -> Workflow:
        glossy = value(extensions, "KHR_materials_pbrSpecularGlossiness", None)
        if glossy is None:
            found = metallic_roughness(self.container, self.pictures, pbr, frame, place)
        else:
            self.findings.note(
                self.container.at(place),
                "specular and glossiness became metal and roughness of the same colours",
            )
            found = specular_glossiness(self.container, self.pictures, glossy, frame, place)
        if tint is not None:
            found.base, found.base_texture = found.base * tint, None
            if tint.ndim == 3:
                found.base_use = {"texture": dict(LOOKUP)}
        return found

    def _index(self, extensions: Json, place: str) -> float:
        ior = number(self.container, value(extensions, "KHR_materials_ior", {}), "ior", 1.5, place)
        if not 1 <= ior <= 100:
            raise InputError.at(
                self.container.at(place), f"an index of refraction is 1 or more, found {ior:g}"
            )
        return ior

    def _specular(self, extensions: Json, frame: Frame, place: str) -> Json:
        """Of KHR_materials_specular: what the dielectric reflects, in colour."""
        entry = value(extensions, "KHR_materials_specular", {})
        factor = number(self.container, entry, "specularFactor", 1.0, place)
        found: Json = {"specular": self._channel(entry, "specularTexture", (factor, 3), frame, place)}
        index = self._index(extensions, place)
        own = ((index - 1) / (index + 1)) ** 2
        colour = np.array(floats(self.container, entry, "specularColorFactor", [1.0] * 3, place))
        if "specularColorTexture" in entry or not np.all(colour == 1.0):
            wanted = ("specularColorTexture", own * np.maximum(colour, 0.0))
            found["specular_colour"] = self._coloured(entry, wanted, frame, place)
        return {} if found == {"specular": 1.0} else found

    def _sheen(self, extensions: Json, frame: Frame, place: str) -> Json:
        """Of KHR_materials_sheen."""
        entry = value(extensions, "KHR_materials_sheen", {})
        colour = np.array(floats(self.container, entry, "sheenColorFactor", [0.0] * 3, place))
        if not np.any(colour > 0):
            return {}
        if "KHR_materials_clearcoat" in extensions:
            self.findings.note(self.container.at(place), "sheen lies over the clear coat, not under it")
        rough = number(self.container, entry, "sheenRoughnessFactor", 0.0, place)
        return {
            "sheen": self._coloured(entry, ("sheenColorTexture", colour), frame, place),
            "sheen_roughness": self._channel(entry, "sheenRoughnessTexture", (rough, 3), frame, place),
        }

    def _coloured(self, entry: Json, wanted: tuple[str, Pixels], frame: Frame, place: str) -> Json:
        """A factor, held at 1, times the colours of a picture where there is one."""
        name, factor = wanted
        if name not in entry:
            return colours.reflectance(np.clip(factor, 0.0, 1.0).tolist())
        pixels = decoded(self.pictures.pixels(entry[name], place)[..., :3])
        use = self.pictures.use(entry[name], frame, place)
        return self.pictures.baked(use, np.clip(factor * pixels, 0.0, 1.0), name)

    def _opaque(self, workflow: Workflow, extensions: Json, frame: Frame, place: str) -> Json:
        index = self._index(extensions, place)
        extras = (
            self._specular(extensions, frame, place)
            | self._clearcoat(extensions, frame, place)
            | self._sheen(extensions, frame, place)
        )
        base = self._base(workflow, place)
        if index == 1.0 and workflow.metallic == 0.0 and not extras:
            return {"type": "lambertian", "reflectance": base}
        return {
            "type": "principled",
            "base": base,
            "metallic": self._scalar(workflow, workflow.metallic, "metallic"),
            "index": index,
            **self._facets(workflow, extensions, frame, place),
            **extras,
        }

    def _facets(self, workflow: Workflow, extensions: Json, frame: Frame, place: str) -> Json:
        """Roughness; by KHR_materials_anisotropy alpha along the brush is alpha + (1 - alpha) strength^2."""
        across = self._scalar(workflow, workflow.rough, "roughness")
        entry = value(extensions, "KHR_materials_anisotropy", {})
        strength: float | Pixels = number(self.container, entry, "anisotropyStrength", 0.0, place)
        if strength == 0.0:
            return {"roughness": across}
        radians = number(self.container, entry, "anisotropyRotation", 0.0, place)
        turns: float | Pixels = radians / (2 * np.pi)
        use = workflow.rough_use
        if "anisotropyTexture" in entry:
            reference = entry["anisotropyTexture"]
            pixels = self.pictures.pixels(reference, place)
            own = self.pictures.use(reference, frame, place)
            turns = turns + np.arctan2(pixels[..., 1:2] * 2 - 1, pixels[..., 0:1] * 2 - 1) / (2 * np.pi)
            strength = strength * pixels[..., 2:3]
            use = use or own
            rough = workflow.rough
            if not isinstance(rough, float) and (use != own or rough.shape != strength.shape):
                self.findings.lost(
                    self.container.at(place),
                    "no support for roughness and brush by textures in different places; the brush is even",
                )
                turns, strength = float(turns.flat[0]), float(strength.mean())
        alpha = workflow.rough**2
        along = (alpha + (1 - alpha) * strength**2) ** 0.5

        def scalar(found: float | Pixels, name: str) -> Json:
            return found if isinstance(found, float) else self.pictures.baked(use, found, name)

        # Half a turn changes nothing.
        return {
            "roughness": scalar(along, "roughness-along"),
            "roughness_across": across,
            "rotation": scalar(turns % 0.5, "brush"),
        }

    def _base(self, workflow: Workflow, place: str) -> Json:
        pixels = workflow.base[..., :3]
        if pixels.ndim == 1:
            return colours.reflectance(pixels.tolist())
        if workflow.base_texture is not None:
            return self.pictures.whole(workflow.base_use, workflow.base_texture, "sRGB", place)
        return self.pictures.baked(workflow.base_use, pixels, "base")

    def _scalar(self, workflow: Workflow, found: float | Pixels, name: str) -> Json:
        return found if isinstance(found, float) else self.pictures.baked(workflow.rough_use, found, name)

    def _clearcoat(self, extensions: Json, frame: Frame, place: str) -> Json:
        """Of KHR_materials_clearcoat: varnish over everything, of index 1.5."""
        entry = value(extensions, "KHR_materials_clearcoat", {})
        amount = number(self.container, entry, "clearcoatFactor", 0.0, place)
        if amount == 0.0:
            return {}
        if "clearcoatNormalTexture" in entry:
            self.findings.lost(
                self.container.at(place),
                "no support for a clear coat's own normals; it has those of what is below",
            )
        rough = number(self.container, entry, "clearcoatRoughnessFactor", 0.0, place)
        return {
            "coat": self._channel(entry, "clearcoatTexture", (amount, 0), frame, place),
            "coat_roughness": self._channel(entry, "clearcoatRoughnessTexture", (rough, 1), frame, place),
        }

    def _channel(self, entry: Json, name: str, wanted: tuple[float, int], frame: Frame, place: str) -> Json:
        """A factor, times a channel of a picture where there is one."""
        factor, channel = wanted
        if name not in entry:
            return factor
        pixels = self.pictures.pixels(entry[name], place)
        pixels = pixels[..., channel : channel + 1] if pixels.shape[2] > channel else np.ones((1, 1, 1))
        use = self.pictures.use(entry[name], frame, place)
        return self.pictures.baked(use, factor * pixels, name)

    def _transmitting(
        self, opaque: Json, workflow: Workflow, extensions: Json, frame: Frame, place: str
    ) -> Json:
        transmission = value(extensions, "KHR_materials_transmission", None)
        if transmission is None:
            return opaque
        factor = number(self.container, transmission, "transmissionFactor", 0.0, place)
        if "transmissionTexture" in transmission:
            pixels = self.pictures.pixels(transmission["transmissionTexture"], place)
            use = self.pictures.use(transmission["transmissionTexture"], frame, place)
            weight: Json = self.pictures.baked(use, factor * pixels[..., 0:1], "transmission")
        else:
            weight = factor
        volume = value(extensions, "KHR_materials_volume", {})
        rough = workflow.rough if isinstance(workflow.rough, float) else float(workflow.rough.mean())
        if number(self.container, volume, "thicknessFactor", 0.0, place) > 0:
            glass: Json = {"type": "dielectric", "index": self._dispersive(extensions, place)}
            if rough > 0:
                glass["roughness"] = rough**2
            glass |= self._absorption(volume, place)
        else:
            glass = {"type": "thin_pane", "index": self._index(extensions, place)}
            tint = workflow.base[..., :3].reshape(-1, 3).mean(axis=0).tolist()
            if tint != [1.0, 1.0, 1.0]:
                glass["transmittance"] = colours.reflectance(tint)
            if rough > 0:
                self.findings.lost(self.container.at(place), "no support for a thin sheet that is rough")
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
