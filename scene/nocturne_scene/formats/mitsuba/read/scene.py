"""A whole scene of Mitsuba's: the order in which its elements become a document."""

from collections.abc import Callable
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.emitters import add_emitter
from nocturne_scene.formats.mitsuba.read.sensors import add_integrator, add_sensor
from nocturne_scene.formats.mitsuba.read.shapes import add_shape
from nocturne_scene.formats.mitsuba.read.tree import SceneTree
from nocturne_scene.formats.reading.boundaries import between_indices
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import SceneFiles
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter

# In this order: lamps without a size get theirs from that of all shapes together, and a medium around the
# sensor is everywhere unless a shape encloses it.
_PARTS: dict[str, Callable[[Context, Element], None]] = {
    "integrator": add_integrator,
    "shape": add_shape,
    "sensor": add_sensor,
    "emitter": add_emitter,
}
# Made where something refers to them.
_REFERRED = ("bsdf", "film", "medium", "rfilter", "rgb", "sampler", "spectrum", "texture")


def _hide_emitters(document: Json) -> None:
    """Let the camera see past all lights, and mirrors show them, as Mitsuba does."""
    surfaces = [document.get("surfaces", ()), *document.get("groups", {}).values()]
    lights = [surface["luminaire"] for group in surfaces for surface in group if "luminaire" in surface]
    for light in [*lights, *([document["environment"]] if "environment" in document else [])]:
        light.setdefault("hidden_from", "camera")


def import_mitsuba(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Read a scene into a writer. Raises InputError."""
    tree = SceneTree(SceneFiles(options.root or file.parent), file.resolve(), options.parameters, findings)
    context = Context(tree, writer, findings, options)
    for element in tree.other_elements(*_PARTS, *_REFERRED):
        findings.lost(element.place, f"no support for <{element.tag}>")
    for tag, add in _PARTS.items():
        for element in tree.elements(tag):
            with findings.leaving_out():
                add(context, element)
        if tag == "shape":
            surfaces, instances = context.crowds.written()
            writer.document |= {"surfaces": surfaces} if surfaces else {}
            writer.document |= {"instances": instances} if instances else {}
    between_indices(writer, findings)
    if context.hides_emitters:
        _hide_emitters(writer.document)
    if "sensor" not in writer.document:
        raise InputError.at(tree.files.shown(file.resolve()), "the scene has no sensor that can be imported")
