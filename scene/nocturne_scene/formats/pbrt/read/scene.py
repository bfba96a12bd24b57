"""A whole scene of pbrt's: directives in the order of the file, and the graphics state that they change."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import camera, lights, materials, media, objects, placing, spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters, Stream
from nocturne_scene.formats.pbrt.read.reader import Directive, Reader, RecordedShape
from nocturne_scene.formats.pbrt.read.shapes import add_surface, gathered
from nocturne_scene.formats.pbrt.read.upgrade import upgrade
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.boundaries import between_indices
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import SceneFiles
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter


def _begin_world(reader: Reader, stream: Stream, place: str) -> None:
    if "sensor" not in reader.context.writer.document:
        raise InputError.at(place, "the scene has no camera before its world begins")
    reader.in_world = True
    reader.context.state.transform = transforms.IDENTITY
    reader.context.coordinate_systems["world"] = transforms.IDENTITY


def _shape(reader: Reader, stream: Stream, place: str) -> None:
    context = reader.context
    kind = stream.string(place)
    given = [*context.state.defaults.get("shape", []), *stream.parameters(place)]
    kind, given = upgrade(context, "shape", kind, given, place)
    if not reader.in_world:
        raise InputError.at(place, "a shape before the world begins")
    if reader.recording is not None:
        reader.record(RecordedShape(kind, given, place, replace(context.state)))
        return
    with context.findings.leaving_out():
        parameters = context.parameters(f"shape {kind}", place, given)
        add_surface(context, context.crowds, kind, parameters)


def _kernel(reader: Reader, kind: str, parameters: Parameters) -> tuple[Json, Json]:
    """Of a material; grey in place of one that is wrong."""
    with reader.context.findings.leaving_out():
        return materials.material(reader.context, kind, parameters)
    return {"type": "lambertian", "reflectance": 0.5}, {}


def _material(reader: Reader, stream: Stream, place: str) -> None:
    kind, parameters = reader.plugin("material", stream, place)
    kernel, normal_or_bump = _kernel(reader, kind, parameters)
    # Written once, however many shapes follow.
    reader.context.state.material = reader.context.writer.name("kernels", kind or "interface", kernel)
    reader.context.state.normal_or_bump = normal_or_bump


def _make_material(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    given = stream.parameters(place)
    kind = next((str(each.values[0]) for each in given if each.name == "type" and each.values), "")
    kind, given = upgrade(reader.context, "material", kind, given, place)
    parameters = reader.context.parameters(f"material {name}", place, given)
    parameters.ignore("type")
    kernel, normal_or_bump = _kernel(reader, kind, parameters)
    reader.context.materials[name] = (reader.context.writer.name("kernels", name, kernel), normal_or_bump)


def _named_material(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name not in reader.context.materials:
        known = ", ".join(sorted(reader.context.materials)[:20]) or "none"
        message = f'no material "{name[:80]}"; known: {known}'
        if reader.context.is_old:
            # pbrt-v3 says so and keeps the one of before: src/core/api.cpp.
            reader.context.findings.lost(place, message)
            return
        raise InputError.at(place, message)
    reader.context.state.material, reader.context.state.normal_or_bump = reader.context.materials[name]


def _texture(reader: Reader, stream: Stream, place: str) -> None:
    name, kind = stream.string(place), stream.string(place)
    plugin, parameters = reader.plugin("texture", stream, place)
    kind = "spectrum" if kind == "color" else kind  # pbrt-v3's word
    with reader.context.findings.leaving_out():
        spectra.add_texture(reader.context, name, kind, plugin, parameters)


def _light(reader: Reader, stream: Stream, place: str) -> None:
    kind, parameters = reader.plugin("light", stream, place)
    with reader.context.findings.leaving_out():
        lights.add_light(reader.context, kind, parameters)


def _area_light(reader: Reader, stream: Stream, place: str) -> None:
    kind = stream.string(place)
    given = [*reader.context.state.defaults.get("light", []), *stream.parameters(place)]
    kind, given = upgrade(reader.context, "area light", kind, given, place)
    reader.context.state.area_light = (kind, given, place)


def _make_medium(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    _, given = upgrade(reader.context, "medium", "", stream.parameters(place), place)
    parameters = reader.context.parameters(f"medium {name}", place, given)
    with reader.context.findings.leaving_out():
        media.add_medium(reader.context, name, parameters)


def _medium_interface(reader: Reader, stream: Stream, place: str) -> None:
    inside = stream.string(place)
    ahead = stream.ahead
    outside = stream.string(place) if ahead is not None and ahead.kind == "string" else inside
    reader.context.state.media = (inside, outside)


def _attribute(reader: Reader, stream: Stream, place: str) -> None:
    target = stream.string(place)
    if target not in ("shape", "light", "material", "medium", "texture"):
        raise InputError.at(place, f'no attributes of "{target[:40]}"')
    defaults = reader.context.state.defaults
    defaults[target] = [*defaults.get(target, []), *stream.parameters(place)]


def _option(reader: Reader, stream: Stream, place: str) -> None:
    given = stream.parameters(place)
    names = ", ".join(parameter.name for parameter in given)
    reader.context.findings.note(place, f"the option {names} is left out")


def _colour_space(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    # pbrt reads it in letters of either case.
    if name.lower() != "srgb":
        reader.context.findings.lost(place, f'no support for the colour space "{name}"; taken as srgb')


def _active_transform(reader: Reader, stream: Stream, place: str) -> None:
    if stream.take(place).text != "All":
        reader.context.findings.lost(place, "transformations that change with time are not supported")


def _transform_times(reader: Reader, stream: Stream, place: str) -> None:
    stream.numbers(2, place)


def _setting(target: str, add: Callable[[Context, str, Parameters], None]) -> Directive:
    def directive(reader: Reader, stream: Stream, place: str) -> None:
        add(reader.context, *reader.plugin(target, stream, place))

    return directive


def _end_world(reader: Reader, stream: Stream, place: str) -> None:
    """The rest of the file is another image of pbrt-v3's."""
    reader.context.is_old = True
    reader.ended = True
    if stream.ahead is not None:
        reader.context.findings.lost(stream.ahead.place, "no support for what follows the end of the world")


def _nothing(context: Context, kind: str, parameters: Parameters) -> None:
    """What speeds pbrt up changes no image."""


_DIRECTIVES: dict[str, Directive] = {
    **placing.DIRECTIVES,
    **objects.DIRECTIVES,
    "ActiveTransform": _active_transform,
    "TransformTimes": _transform_times,
    "Camera": _setting("camera", camera.add_camera),
    "Film": _setting("film", camera.add_film),
    "Sampler": _setting("sampler", camera.add_sampler),
    "Integrator": _setting("integrator", camera.add_integrator),
    "PixelFilter": _setting("filter", camera.add_filter),
    "SurfaceIntegrator": _setting("integrator", camera.add_integrator),  # pbrt-v2's word
    "VolumeIntegrator": _setting("integrator", _nothing),
    "Renderer": _setting("renderer", _nothing),
    "Accelerator": _setting("accelerator", _nothing),
    "Option": _option,
    "ColorSpace": _colour_space,
    "WorldBegin": _begin_world,
    "WorldEnd": _end_world,
    "Attribute": _attribute,
    "Shape": _shape,
    "Material": _material,
    "MakeNamedMaterial": _make_material,
    "NamedMaterial": _named_material,
    "Texture": _texture,
    "LightSource": _light,
    "AreaLightSource": _area_light,
    "MakeNamedMedium": _make_medium,
    "MediumInterface": _medium_interface,
}


def import_pbrt(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Read a scene into a writer. Raises InputError."""
    files = SceneFiles(options.root or file.parent)
    context = Context(files, file.resolve().parent, writer, findings, options)
    writer.film.width, writer.film.height = 1280, 720
    writer.document["tracing"] = {"maximum_depth": 5}
    reader = Reader(context, _DIRECTIVES)
    reader.read(file.resolve(), ())
    if not reader.in_world:
        raise InputError.at(files.shown(file.resolve()), "the scene's world never begins")
    if reader.saved:
        raise InputError.at(files.shown(file.resolve()), "the file ends inside of attributes")
    surfaces, instances = context.crowds.written()
    for found in instances:
        writer.add("instances", found)
    for found in (*surfaces, *gathered(context)):
        writer.add("surfaces", found)
    for add in context.later:
        with findings.leaving_out():
            add()
    between_indices(writer, findings)
