"""Mitsuba's own mesh files (`.serialized`), versions 3 and 4.

A file holds meshes one after the other, each with its own header, and at its end their offsets and their
number. Numbers are little-endian. Source: the description in the documentation of Mitsuba 0.6, section 8.1.5.
"""

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts
from nocturne_scene.meshes.triangles import Triangles

_MAGIC = 0x041C
_NORMALS, _COORDINATES, _COLOURS, _FACE_NORMALS, _DOUBLE = 0x1, 0x2, 0x8, 0x10, 0x2000

# Bytes of one mesh once decompressed.
_MAX_BYTES = 2**30


class _Reader:
    """Takes numbers off a mesh's content."""

    def __init__(self, content: bytes, place: str) -> None:
        self._content, self._at, self._place = content, 0, place

    def unpack(self, layout: str) -> tuple[int, ...]:
        return struct.unpack(layout, self.bytes(struct.calcsize(layout)))

    def bytes(self, count: int) -> bytes:
        if self._at + count > len(self._content):
            raise InputError.at(self._place, "the file ends in the middle of a mesh")
        self._at += count
        return self._content[self._at - count : self._at]

    def name(self) -> None:
        end = self._content.find(b"\0", self._at)
        if end < 0:
            raise InputError.at(self._place, "the file ends in the middle of a mesh")
        self._at = end + 1

    def rows(self, count: int, columns: int, kind: str) -> NDArray[np.float64]:
        size = count * columns * np.dtype(kind).itemsize
        return np.frombuffer(self.bytes(size), kind).reshape(count, columns).astype(np.float64)


def read_serialized(content: bytes, number: int, place: str) -> Triangles:
    """Return the mesh of that number, from 0; v as in the file. Raises InputError."""
    if len(content) < 8:
        raise InputError.at(place, "is no serialized mesh")
    start = _offset(content, number, place)
    magic, version = struct.unpack_from("<HH", content, start)
    if magic != _MAGIC or version not in (3, 4):
        raise InputError.at(place, "is no serialized mesh of version 3 or 4")
    decompressor = zlib.decompressobj()
    try:
        plain = decompressor.decompress(content[start + 4 :], _MAX_BYTES)
    except zlib.error as error:
        raise InputError.at(place, f"can't be decompressed: {error}") from None
    if decompressor.unconsumed_tail:
        raise InputError.at(place, f"a mesh has more than {_MAX_BYTES:,} bytes")
    reader = _Reader(plain, place)
    (flags,) = reader.unpack("<I")
    if version == 4:
        reader.name()
    vertices, triangles = reader.unpack("<QQ")
    try:
        check_counts(vertices, triangles)
    except UnusableMeshError as error:
        raise InputError.at(place, str(error)) from None
    kind = "<f8" if flags & _DOUBLE else "<f4"
    positions = reader.rows(vertices, 3, kind)
    normals = reader.rows(vertices, 3, kind) if flags & _NORMALS else None
    coordinates = reader.rows(vertices, 2, kind) if flags & _COORDINATES else None
    if flags & _COLOURS:
        reader.rows(vertices, 3, kind)
    indices = reader.rows(triangles, 3, "<u4").astype(np.int64)
    if flags & _FACE_NORMALS:
        normals = None
    return Triangles(positions, indices, normals, coordinates)


def _offset(content: bytes, number: int, place: str) -> int:
    (count,) = struct.unpack_from("<I", content, len(content) - 4)
    for width, layout in ((8, "<Q"), (4, "<I")):
        table = len(content) - 4 - width * count
        if count and table >= 4 and struct.unpack_from(layout, content, table)[0] == 0:
            if not 0 <= number < count:
                raise InputError.at(place, f"there is no mesh {number}; the file has {count}")
            (start,) = struct.unpack_from(layout, content, table + width * number)
            if start + 4 > len(content):
                break
            return int(start)
    raise InputError.at(place, "the list of meshes at its end is damaged")
