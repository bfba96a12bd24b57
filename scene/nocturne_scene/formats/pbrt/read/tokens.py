"""Directives of pbrt files: names, strings, numbers and lists, with the line that each is on."""

import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES, read_bytes

# Bytes of a compressed file once it is not.
_MAX_BYTES = 4 * TEXT_BYTES

_TOKEN = re.compile(r'\s+|#[^\n]*|"(?P<string>[^"\n]*)"|(?P<open>\[)|(?P<close>\])|(?P<word>[^\s"\[\]#]+)')


@dataclass(frozen=True)
class Token:
    """A word, a string, or a bracket; numbers are words."""

    kind: str
    text: str
    place: str


def read_text(file: Path, shown: str) -> str:
    """Return a file's text, decompressed if its name ends in .gz. Raises InputError."""
    content = read_bytes(file, TEXT_BYTES, shown)
    if file.suffix == ".gz":
        content = decompressed(content, _MAX_BYTES, shown)
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError.at(shown, f"is not UTF-8 at byte {error.start}") from None


def decompressed(content: bytes, most: int, shown: str) -> bytes:
    """Return what a gzip file holds, in one part or several. Raises InputError for more than `most` bytes."""
    plain = bytearray()
    while content or not plain:
        decompressor = zlib.decompressobj(wbits=31)
        try:
            plain += decompressor.decompress(content, most + 1 - len(plain))
        except zlib.error as error:
            raise InputError.at(shown, f"can't be decompressed: {error}") from None
        if len(plain) > most or not decompressor.eof:
            raise InputError.at(shown, f"has more than {most:,} bytes once decompressed, or ends too early")
        content = decompressor.unused_data
        if not plain and not content:
            break
    return bytes(plain)


def tokens(text: str, shown: str) -> Iterator[Token]:
    """Yield the tokens of a file. Raises InputError."""
    line, counted, at = 1, 0, 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        line += text.count("\n", counted, at)
        counted = at
        if match is None:
            raise InputError.at(f"{shown}:{line}", f'unexpected "{text[at : at + 20]}"')
        if match.lastgroup is not None:
            yield Token(match.lastgroup, match[match.lastgroup], f"{shown}:{line}")
        at = match.end()
