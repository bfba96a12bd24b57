"""Directives that place the objects after them: the current transformation matrix."""

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.parameters import Stream
from nocturne_scene.formats.pbrt.read.reader import Directive, Reader
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.transforms import Matrix


def _identity(reader: Reader, stream: Stream, place: str) -> None:
    reader.context.state.transform = transforms.IDENTITY


def _translate(reader: Reader, stream: Stream, place: str) -> None:
    reader.apply(transforms.translation(stream.numbers(3, place)))


def _scale(reader: Reader, stream: Stream, place: str) -> None:
    factors = stream.numbers(3, place)
    if 0.0 in factors:
        raise InputError.at(place, "a scale of 0 leaves nothing")
    reader.apply(transforms.scaling(factors))


def _rotate(reader: Reader, stream: Stream, place: str) -> None:
    degrees, *axis = stream.numbers(4, place)
    try:
        reader.apply(transforms.rotation(axis, degrees))
    except ValueError as error:
        raise InputError.at(place, str(error)) from None


def _look_at(reader: Reader, stream: Stream, place: str) -> None:
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


def _transform(reader: Reader, stream: Stream, place: str) -> None:
    reader.context.state.transform = _matrix(stream, place)


def _concat_transform(reader: Reader, stream: Stream, place: str) -> None:
    reader.apply(_matrix(stream, place))


def _coordinate_system(reader: Reader, stream: Stream, place: str) -> None:
    reader.context.coordinate_systems[stream.string(place)] = reader.context.state.transform


def _use_coordinate_system(reader: Reader, stream: Stream, place: str) -> None:
    name = stream.string(place)
    if name not in reader.context.coordinate_systems:
        raise InputError.at(place, f'no coordinate system "{name[:80]}"')
    reader.context.state.transform = reader.context.coordinate_systems[name]


def _reverse(reader: Reader, stream: Stream, place: str) -> None:
    reader.context.state.reversed = not reader.context.state.reversed


DIRECTIVES: dict[str, Directive] = {
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
}
