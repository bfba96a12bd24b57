"""Light of glTF's materials: emission, and colours of unlit ones; parts that are cut out do not shine."""

import numpy as np

from nocturne_scene.formats.gltf.read.container import Container, floats, number, value
from nocturne_scene.formats.gltf.read.coordinates import Frame
from nocturne_scene.formats.gltf.read.pictures import Pictures, Pixels
from nocturne_scene.formats.gltf.read.workflows import Workflow, resized
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.textures.image_files import decoded


def opacity(container: Container, entry: Json, workflow: Workflow, place: str) -> float | Pixels:
    """How much of a material is there, by its alpha mode; as a picture of shape (rows, columns, 1)."""
    mode = value(entry, "alphaMode", "OPAQUE")
    if mode == "OPAQUE":
        return 1.0
    cutoff = number(container, entry, "alphaCutoff", 0.5, place)
    alpha = workflow.base[..., 3:4]
    shown = alpha if mode == "BLEND" else (alpha >= cutoff).astype(float)
    return float(shown.flat[0]) if np.all(shown == shown.flat[0]) else shown


def unlit(pictures: Pictures, workflow: Workflow, shown: float | Pixels, place: str) -> Json | None:
    """Radiance of the base colour, 1 cd/m2 where that is white; None where nothing is there."""
    pictures.findings.note(
        pictures.container.at(place),
        "a material that no light falls on became one that emits its colour, in cd/m2",
    )
    if workflow.base.ndim == 1 and isinstance(shown, float):
        return _or_none(colours.light((shown * workflow.base[:3]).tolist(), 1.0))
    white = colours.light([1.0, 1.0, 1.0], 1.0)
    if workflow.base_texture is not None and isinstance(shown, float):
        use = pictures.whole(workflow.base_use, workflow.base_texture, "sRGB", place)
        return _or_none(colours.scaled({**use, "spectrum": white}, shown))
    use = pictures.baked(workflow.base_use, shown * workflow.base[..., :3], "base")
    return {**use, "spectrum": white}


def emission(
    pictures: Pictures, entry: Json, workflow: Workflow, shown: float | Pixels, frame: Frame, place: str
) -> Json | None:
    """Radiance of `emissiveFactor` and its texture, in cd/m2; None without any."""
    container = pictures.container
    factor = floats(container, entry, "emissiveFactor", [0.0] * 3, place)
    strength = value(value(entry, "extensions", {}), "KHR_materials_emissive_strength", {})
    luminance = number(container, strength, "emissiveStrength", 1.0, place)
    if not max(factor) > 0:
        return None
    radiance = colours.light(factor, luminance)
    reference = value(entry, "emissiveTexture", None)
    if isinstance(shown, float):
        if reference is not None:
            use = pictures.use(reference, frame, place)
            radiance = {**pictures.whole(use, reference, "sRGB", place), "spectrum": radiance}
        return _or_none(colours.scaled(radiance, shown))
    if reference is not None:
        use, stored = pictures.use(reference, frame, place), pictures.pixels(reference, place)
        if use != workflow.base_use:
            pictures.findings.lost(
                container.at(place),
                "no support for emission and opacity by textures in different places; what is cut out shines",
            )
            return {**pictures.whole(use, reference, "sRGB", place), "spectrum": radiance}
        rows, columns = (max(shown.shape[axis], stored.shape[axis]) for axis in (0, 1))
        emitted = decoded(resized(stored[..., :3], rows, columns)).astype(np.float64)
        shown = np.asarray(resized(shown, rows, columns) * emitted)
    return {**pictures.baked(workflow.base_use, shown, "emission"), "spectrum": radiance}


def _or_none(radiance: Json) -> Json | None:
    """A radiance that is not nothing."""
    spectrum = radiance.get("spectrum", 1.0) if isinstance(radiance, dict) else radiance
    return None if spectrum == 0.0 else radiance
