"""A whole scene of pbrt's: directives in the order of the file, and the graphics state that they change."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import camera, lights, materials, media, spectra
from nocturne_scene.formats.pbrt.read.context import Context, State
from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters, Stream
from nocturne_scene.formats.pbrt.read.shapes import surface
from nocturne_scene.formats.pbrt.read.tokens import read_text, tokens
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import SceneFiles
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.transforms import Matrix

# Directives of former versions.
_OLD = ("WorldEnd", "SurfaceIntegrator", "VolumeIntegrator", "Renderer", "Volume")
_MAX_DEPTH = 64
_MAX_INCLUDES = 16
# Directives of a scene, those of included files each time.
_MAX_DIRECTIVES = 1_000_000


@dataclass
class _Shape:
    """A shape of an object, to be made where instances need it."""

    kind: str
    given: list[Parameter]
    place: str
    state: State


@dataclass
class _Reader:
    """Follows the directives of one scene."""

    context: Context
    saved: list[State] = field(default_factory=list)
    objects: dict[str, list[_Shape]] = field(default_factory=dict)
    groups: dict[str, str] = field(default_factory=dict)
    recording: str | None = None
    in_world: bool = False
    count: int = 0

    def read(self, file: Path, opened: tuple[Path, ...]) -> None:
        """All directives of a file and of those that it includes."""
        shown = self.context.files.shown(file)
        if file in opened:
            raise InputError.at(shown, "includes itself")
        if len(opened) >= _MAX_INCLUDES:
            raise InputError.at(shown, f"files are included more than {_MAX_INCLUDES} deep")
        stream = Stream(tokens(read_text(file, shown), shown))
        while stream.ahead is not None:
            token = stream.take(shown)
            self.count += 1
            if self.count > _MAX_DIRECTIVES:
                raise InputError.at(token.place, f"more than {_MAX_DIRECTIVES:,} directives")
            if token.kind != "word" or (
                token.text not in _DIRECTIVES and token.text not in ("Include", "Import")
            ):
                old = " of pbrt-v4: the file is of pbrt-v3 or before; `pbrt --upgrade` rewrites it"
                hint = old if token.text in _OLD else ""
                raise InputError.at(token.place, f'no directive "{token.text[:40]}"{hint}')
            if token.text in ("Include", "Import"):
                name = stream.string(token.place)
                self.read(self.context.file(name, token.place), (*opened, file))
            else:
                _DIRECTIVES[token.text](self, stream, token.place)

    def apply(self, matrix: Matrix) -> None:
        """Coordinates of what follows are inside of those of now."""
        self.context.state.transform = self.context.state.transform @ matrix

    def plugin(self, target: str, stream: Stream, place: str) -> tuple[str, Parameters]:
        """A plugin's name and its parameters, the defaults of `Attribute` first."""
        kind = stream.string(place)
        given = [*self.context.state.defaults.get(target, []), *stream.parameters(place)]
        return kind, self.context.parameters(f"{target} {kind}".strip(), place, given)


_Directive = Callable[[_Reader, Stream, str], None]


def _identity(reader: _Reader, stream: Stream, place: str) -> None:
    reader.context.state.transform = transforms.IDENTITY


def _translate(reader: _Reader, stream: Stream, place: str) -> None:
    reader.apply(transforms.translation(stream.numbers(3, place)))


def _scale(reader: _Reader, stream: Stream, place: str) -> None:
    factors = stream.numbers(3, place)
    if 0.0 in factors:
        raise InputError.at(place, "a scale of 0 leaves nothing")
    reader.apply(transforms.scaling(factors))


def _rotate(reader: _Reader, stream: Stream, place: str) -> None:
    degrees, *axis = stream.numbers(4, place)
    try:
        reader.apply(transforms.rotation(axis, degrees))
    except ValueError as error:
        raise InputError.at(place, str(error)) from None


def _look_at(reader: _Reader, stream: Stream, place: str) -> None:
    values = stream.numbers(9, place)
    try:
        # As numbers, the same matrix: pbrt's x is to the right of a left-handed world.
        reader.apply(transforms.inverse(transforms.look_at(values[:3], values[3:6], values[6:])))
    except ValueError as error:
        raise InputError.at(place, str(error)) from None


def _matrix(stream: Stream, place: str) -> Matrix:
    matrix = np.array(stream.numbers(16, place)).reshape(4, 4).T
    if list(matrix[3]) != [0.0, 0.0, 0.0, 1.0] or not abs(np.linalg.det(matrix)) > 0:
        raise InputError.at(place, "the matrix flattens space, or has perspective")
    return matrix


def _transform(reader: _Reader, stream: Stream, place: str) -> None:
    reader.context.state.transform = _matrix(stream, place)


def _concat_transform(reader: _Reader, stream: Stream, place: str) -> None:
    reader.apply(_matrix(stream, place))


def _coordinate_system(reader: _Reader, stream: Stream, place: str) -> None:
    reader.context.coordinate_systems[stream.string(place)] = reader.context.state.transform


def _use_coordinate_system(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name not in reader.context.coordinate_systems:
        raise InputError.at(place, f'no coordinate system "{name[:80]}"')
    reader.context.state.transform = reader.context.coordinate_systems[name]


def _reverse(reader: _Reader, stream: Stream, place: str) -> None:
    reader.context.state.reversed = not reader.context.state.reversed


def _begin_world(reader: _Reader, stream: Stream, place: str) -> None:
    if "sensor" not in reader.context.writer.document:
        raise InputError.at(place, "the scene has no camera before its world begins")
    reader.in_world = True
    reader.context.state.transform = transforms.IDENTITY
    reader.context.coordinate_systems["world"] = transforms.IDENTITY


def _begin(reader: _Reader, stream: Stream, place: str) -> None:
    if len(reader.saved) >= _MAX_DEPTH:
        raise InputError.at(place, f"attributes are nested more than {_MAX_DEPTH} deep")
    state = reader.context.state
    reader.saved.append(replace(state, defaults=dict(state.defaults)))


def _end(reader: _Reader, stream: Stream, place: str) -> None:
    if not reader.saved:
        raise InputError.at(place, "ends what did not begin")
    reader.context.state = reader.saved.pop()


def _begin_object(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if reader.recording is not None or name in reader.objects:
        raise InputError.at(place, f'the object "{name[:80]}" is inside of another, or there are two')
    _begin(reader, stream, place)
    reader.recording = name
    reader.objects[name] = []


def _end_object(reader: _Reader, stream: Stream, place: str) -> None:
    if reader.recording is None:
        raise InputError.at(place, "ends an object that did not begin")
    _end(reader, stream, place)
    reader.recording = None


def _instance(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name not in reader.objects or name == reader.recording:
        raise InputError.at(place, f'no object "{name[:80]}"')
    context = reader.context
    placed = context.outer @ context.state.transform @ transforms.inverse(context.outer)
    factor = transforms.similarity(placed)
    if factor is None or transforms.is_mirrored(placed):
        context.findings.note(place, "an instance that is stretched or mirrored became a copy")
        for each in _made(context, reader.objects[name], placed @ context.outer):
            context.writer.add("surfaces", each)
        return
    if name not in reader.groups:
        members = _made(context, reader.objects[name], context.outer)
        if not members:
            return
        reader.groups[name] = context.writer.name("groups", name, members)
    instance: Json = {"group": reader.groups[name], "translate": placed[:3, 3].tolist(), "scale": factor}
    turn = transforms.rotation_of(placed[:3, :3] / factor)
    if turn is not None:
        instance["rotate"] = {"axis": turn[0], "degrees": turn[1]}
    context.writer.add("instances", instance)


def _made(context: Context, recorded: list[_Shape], outer: Matrix) -> list[Json]:
    """The surfaces of an object, `outer` in place of the context's own."""
    state, kept = context.state, context.outer
    context.outer = outer
    found = []
    for shape in recorded:
        context.state = shape.state
        with context.findings.leaving_out():
            found.append(
                surface(
                    context, shape.kind, context.parameters(f"shape {shape.kind}", shape.place, shape.given)
                )
            )
    context.state, context.outer = state, kept
    return [each for each in found if each is not None]


def _shape(reader: _Reader, stream: Stream, place: str) -> None:
    context = reader.context
    kind = stream.string(place)
    given = [*context.state.defaults.get("shape", []), *stream.parameters(place)]
    if not reader.in_world:
        raise InputError.at(place, "a shape before the world begins")
    if reader.recording is not None:
        reader.objects[reader.recording].append(_Shape(kind, given, place, replace(context.state)))
        return
    with context.findings.leaving_out():
        found = surface(context, kind, context.parameters(f"shape {kind}", place, given))
        if found is not None:
            context.writer.add("surfaces", found)


def _kernel(reader: _Reader, kind: str, parameters: Parameters) -> tuple[Json, Json]:
    """Of a material; grey in place of one that is wrong."""
    with reader.context.findings.leaving_out():
        return materials.material(reader.context, kind, parameters)
    return {"type": "lambertian", "reflectance": 0.5}, {}


def _material(reader: _Reader, stream: Stream, place: str) -> None:
    kind, parameters = reader.plugin("material", stream, place)
    kernel, relief = _kernel(reader, kind, parameters)
    # Written once, however many shapes follow.
    reader.context.state.material = reader.context.writer.name("kernels", kind or "interface", kernel)
    reader.context.state.relief = relief


def _make_material(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    parameters = reader.context.parameters(f"material {name}", place, stream.parameters(place))
    kind = parameters.word("type", "")
    kernel, relief = _kernel(reader, kind, parameters)
    reader.context.materials[name] = (reader.context.writer.name("kernels", name, kernel), relief)


def _named_material(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name not in reader.context.materials:
        known = ", ".join(sorted(reader.context.materials)[:20]) or "none"
        raise InputError.at(place, f'no material "{name[:80]}"; known: {known}')
    reader.context.state.material, reader.context.state.relief = reader.context.materials[name]


def _texture(reader: _Reader, stream: Stream, place: str) -> None:
    name, kind = stream.string(place), stream.string(place)
    plugin, parameters = reader.plugin("texture", stream, place)
    reader.context.textures[name] = 0.5
    with reader.context.findings.leaving_out():
        spectra.add_texture(reader.context, name, kind, plugin, parameters)


def _light(reader: _Reader, stream: Stream, place: str) -> None:
    kind, parameters = reader.plugin("light", stream, place)
    with reader.context.findings.leaving_out():
        lights.add_light(reader.context, kind, parameters)


def _area_light(reader: _Reader, stream: Stream, place: str) -> None:
    kind = stream.string(place)
    given = [*reader.context.state.defaults.get("light", []), *stream.parameters(place)]
    reader.context.state.area_light = (kind, given, place)


def _make_medium(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    parameters = reader.context.parameters(f"medium {name}", place, stream.parameters(place))
    with reader.context.findings.leaving_out():
        media.add_medium(reader.context, name, parameters)


def _medium_interface(reader: _Reader, stream: Stream, place: str) -> None:
    inside = stream.string(place)
    ahead = stream.ahead
    outside = stream.string(place) if ahead is not None and ahead.kind == "string" else inside
    reader.context.state.media = (inside, outside)


def _attribute(reader: _Reader, stream: Stream, place: str) -> None:
    target = stream.string(place)
    if target not in ("shape", "light", "material", "medium", "texture"):
        raise InputError.at(place, f'no attributes of "{target[:40]}"')
    defaults = reader.context.state.defaults
    defaults[target] = [*defaults.get(target, []), *stream.parameters(place)]


def _option(reader: _Reader, stream: Stream, place: str) -> None:
    given = stream.parameters(place)
    names = ", ".join(parameter.name for parameter in given)
    reader.context.findings.note(place, f"the option {names} is left out")


def _colour_space(reader: _Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name != "srgb":
        reader.context.findings.lost(place, f'no equal of the colour space "{name}"; taken as srgb')


def _active_transform(reader: _Reader, stream: Stream, place: str) -> None:
    if stream.take(place).text != "All":
        reader.context.findings.lost(place, "transformations that change with time have no equal")


def _transform_times(reader: _Reader, stream: Stream, place: str) -> None:
    stream.numbers(2, place)


def _setting(target: str, add: Callable[[Context, str, Parameters], None]) -> _Directive:
    def directive(reader: _Reader, stream: Stream, place: str) -> None:
        add(reader.context, *reader.plugin(target, stream, place))

    return directive


def _nothing(context: Context, kind: str, parameters: Parameters) -> None:
    """What speeds pbrt up changes no image."""


_DIRECTIVES: dict[str, _Directive] = {
    "Identity": _identity,
    "Translate": _translate,
    "Scale": _scale,
    "Rotate": _rotate,
    "LookAt": _look_at,
    "Transform": _transform,
    "ConcatTransform": _concat_transform,
    "CoordinateSystem": _coordinate_system,
    "CoordSysTransform": _use_coordinate_system,
    "ReverseOrientation": _reverse,
    "ActiveTransform": _active_transform,
    "TransformTimes": _transform_times,
    "Camera": _setting("camera", camera.add_camera),
    "Film": _setting("film", camera.add_film),
    "Sampler": _setting("sampler", camera.add_sampler),
    "Integrator": _setting("integrator", camera.add_integrator),
    "PixelFilter": _setting("filter", camera.add_filter),
    "Accelerator": _setting("accelerator", _nothing),
    "Option": _option,
    "ColorSpace": _colour_space,
    "WorldBegin": _begin_world,
    "AttributeBegin": _begin,
    "AttributeEnd": _end,
    "TransformBegin": _begin,
    "TransformEnd": _end,
    "Attribute": _attribute,
    "ObjectBegin": _begin_object,
    "ObjectEnd": _end_object,
    "ObjectInstance": _instance,
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
    reader = _Reader(context)
    reader.read(file.resolve(), ())
    if not reader.in_world:
        raise InputError.at(files.shown(file.resolve()), "the scene's world never begins")
    if reader.saved:
        raise InputError.at(files.shown(file.resolve()), "the file ends inside of attributes")
    for add in context.later:
        with findings.leaving_out():
            add()
