"""Directives that nest: attributes that end with a block, and objects that are placed several times."""

from dataclasses import replace

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Stream
from nocturne_scene.formats.pbrt.read.reader import Directive, Reader, RecordedShape
from nocturne_scene.formats.pbrt.read.shapes import add_surface
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.crowds import Crowds
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


def _end_transform(reader: Reader, stream: Stream, place: str) -> None:
    """In pbrt-v3 all but the transformation stays (src/core/api.cpp); in pbrt-v4 it is an AttributeEnd."""
    now = reader.context.state
    _end(reader, stream, place)
    if reader.context.is_old:
        reader.context.state = replace(now, transform=reader.context.state.transform)


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
    if not transforms.is_even(placed):
        context.findings.note(place, "an instance that is stretched or mirrored became a copy")
        _add_members(context, context.crowds, reader.objects[name], placed @ context.outer)
        return
    if name not in reader.groups:
        crowds = Crowds(context.writer, context.findings)
        _add_members(context, crowds, reader.objects[name], context.outer)
        members = [each for found in crowds.written() for each in found]
        # Where nothing is left of an object that is known of its other instances, too.
        reader.groups[name] = context.writer.name("groups", name, members) if members else ""
    if reader.groups[name]:
        context.crowds.instance(reader.groups[name], placed)


def _add_members(context: Context, crowds: Crowds, recorded: list[RecordedShape], outer: Matrix) -> None:
    """The surfaces of an object, `outer` in place of the context's own."""
    state, kept = context.state, context.outer
    context.outer = outer
    for shape in recorded:
        context.state = shape.state
        parameters = context.parameters(f"shape {shape.kind}", shape.place, shape.given)
        with context.findings.leaving_out():
            add_surface(context, crowds, shape.kind, parameters, of_object=True)
    context.state, context.outer = state, kept


DIRECTIVES: dict[str, Directive] = {
    "AttributeBegin": _begin,
    "AttributeEnd": _end,
    "TransformBegin": _begin,
    "TransformEnd": _end_transform,
    "ObjectBegin": _begin_object,
    "ObjectEnd": _end_object,
    "ObjectInstance": _instance,
}
