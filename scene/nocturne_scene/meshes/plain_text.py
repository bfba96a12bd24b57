"""Mesh files of other systems as loaders take them: without byte order marks, CR line ends, tabs, SOLID."""

import codecs
import mmap
import os
import re
import shutil
import tempfile
from typing import BinaryIO, cast

from nocturne_scene import limits
from nocturne_scene.document.fields import MeshFormat
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.texts import text_of

_BYTE_ORDER_MARKS = (codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
# Of OBJ files: tabs, blanks before the first word of a line, and ends of lines.
_NOT_PLAIN = re.compile(rb"\t|\r(?!\n)|^ ", re.MULTILINE)
_CR = re.compile(rb"\r(?!\n)")
_PLY_HEADER_BYTES = 64 * 1024
_PLY_HEADER = re.compile(rb".*?end_header(?:\r\n|\r|\n)", re.DOTALL)
_STL_START_BYTES = 512


def plain_text(file: BinaryIO, file_format: MeshFormat) -> BinaryIO:
    """The file at its start, or a temporary one with the same in plain text. Raises UnusableMeshError."""
    size = file.seek(0, os.SEEK_END)
    file.seek(0)
    if not 0 < size <= limits.MAX_ASSET_BYTES:
        return file
    try:
        found = _rewritten(file, file_format)
    except UnicodeError as error:
        raise UnusableMeshError(f"the file is no text: {error}") from None
    file.seek(0)
    return file if found is None else found


def _rewritten(file: BinaryIO, file_format: MeshFormat) -> BinaryIO | None:
    match file_format:
        case "obj":
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                is_plain = not content[:3].startswith(_BYTE_ORDER_MARKS) and not _NOT_PLAIN.search(content)
            return None if is_plain else _as_lines(file)
        case "ply":
            return _ply(file)
        case "stl":
            start = file.read(_STL_START_BYTES)
            file.seek(0)
            text = start.removeprefix(codecs.BOM_UTF8).lstrip()
            if text[:5].lower() != b"solid" or b"\0" in start:
                return None
            is_plain = start.startswith(b"solid") and not _CR.search(start)
            return None if is_plain else _as_lines(file, lower=True)
    return None


def _ply(file: BinaryIO) -> BinaryIO | None:
    """Only the header of a binary file is text."""
    match = _PLY_HEADER.match(file.read(_PLY_HEADER_BYTES))
    if match is None:
        return None
    header = match[0].removeprefix(codecs.BOM_UTF8)
    file.seek(0)
    if header == match[0] and not _CR.search(header) and _is_utf_8(header):
        return None
    if b"format ascii" in header:
        return _as_lines(file)
    made = _temporary()
    plain = header.replace(b"\r\n", b"\n").replace(b"\r", b"\n").decode("ascii", "replace")
    made.write(plain.encode("ascii", "replace"))
    file.seek(match.end())
    shutil.copyfileobj(file, made)
    made.seek(0)
    return made


def _is_utf_8(text: bytes) -> bool:
    try:
        text.decode()
    except UnicodeDecodeError:
        return False
    return True


def _as_lines(file: BinaryIO, *, lower: bool = False) -> BinaryIO:
    made = _temporary()
    text = text_of(file)
    for line in text:
        plain = line.replace("\t", " ").lstrip(" ")
        made.write((plain.lower() if lower else plain).encode())
    # The file is closed by who opened it.
    text.detach()
    made.seek(0)
    return made


def _temporary() -> BinaryIO:
    # With a name, which loaders show as that of the mesh.
    return cast(BinaryIO, tempfile.NamedTemporaryFile(suffix="-mesh"))
