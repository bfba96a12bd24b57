"""Directives that nest: attributes that end with a block, and objects that are placed several times."""

from dataclasses import replace

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Stream
from nocturne_scene.formats.pbrt.read.reader import Directive, Reader, RecordedShape
from nocturne_scene.formats.pbrt.read.shapes import surface
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix

_MAX_DEPTH = 64


def _begin(reader: Reader, stream: Stream, place: str) -> None:
    if len(reader.saved) >= _MAX_DEPTH:
        raise InputError.at(place, f"attributes are nested more than {_MAX_DEPTH} deep")
    state = reader.context.state
    reader.saved.append(replace(state, defaults=dict(state.defaults)))


def _end(reader: Reader, stream: Stream, place: str) -> None:
    if not reader.saved:
        raise InputError.at(place, "ends what did not begin")
    reader.context.state = reader.saved.pop()


def _begin_object(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if reader.recording is not None or name in reader.objects:
        raise InputError.at(place, f'the object "{name[:80]}" is inside of another, or there are two')
    _begin(reader, stream, place)
    reader.recording = name
    reader.objects[name] = []


def _end_object(reader: Reader, stream: Stream, place: str) -> None:
    if reader.recording is None:
        raise InputError.at(place, "ends an object that did not begin")
    _end(reader, stream, place)
    reader.recording = None


def _instance(reader: Reader, stream: Stream, place: str) -> None:
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


def _made(context: Context, recorded: list[RecordedShape], outer: Matrix) -> list[Json]:
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


DIRECTIVES: dict[str, Directive] = {
    "AttributeBegin": _begin,
    "AttributeEnd": _end,
    "TransformBegin": _begin,
    "TransformEnd": _end,
    "ObjectBegin": _begin_object,
    "ObjectEnd": _end_object,
    "ObjectInstance": _instance,
}
