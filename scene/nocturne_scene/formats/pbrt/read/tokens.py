"""Directives of pbrt files: names, strings, numbers and lists, with the line that each is on."""

import io
import os
import re
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES, read_bytes
from nocturne_scene.texts import text_of

# Bytes of a compressed file once it is not.
_MAX_BYTES = 4 * TEXT_BYTES

# Of a file that is read line by line, and of one line.
_MAX_FILE_BYTES = 2**30
_MAX_LINE = TEXT_BYTES

_NUMBER = r"[-+.0-9][-+.0-9eE]*"
_TOKEN = re.compile(
    rf'\s+|#[^\n]*|"(?P<string>(?:[^"\\\n]|\\[^\n])*)"|(?P<open>\[)|(?P<close>\])'
    rf'|(?P<numbers>{_NUMBER}(?:[ \t]+{_NUMBER}){{2,999}}(?=[\s\]#]|$))|(?P<word>[^\s"\[\]#]+)'
)

# In strings. A backslash before anything else is one of a path of Windows, though an escape in pbrt.
_ESCAPED = re.compile(r"\\([\\\"'])")


@dataclass(frozen=True)
class Token:
    """A word, a string, or a bracket; numbers are words, or several together."""

    kind: str
    text: str
    place: str


def read_lines(file: Path, shown: str) -> Iterator[str]:
    """Yield a file's lines, decompressed if its name ends in .gz. Raises InputError."""
    try:
        if file.suffix == ".gz":
            content = decompressed(read_bytes(file, TEXT_BYTES, shown), _MAX_BYTES, shown)
            yield from text_of(io.BytesIO(content))
            return
        with text_of(file.open("rb")) as opened:
            if os.fstat(opened.fileno()).st_size > _MAX_FILE_BYTES:
                raise InputError.at(shown, f"has more than {_MAX_FILE_BYTES:,} bytes")
            while line := opened.readline(_MAX_LINE + 1):
                if len(line) > _MAX_LINE:
                    raise InputError.at(shown, f"has a line of more than {_MAX_LINE:,} characters")
                yield line
    except UnicodeError as error:
        raise InputError.at(shown, f"is no text: {error}") from None
    except OSError as error:
        raise InputError.at(shown, f"can't be read: {error.strerror}") from None


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


def tokens(lines: Iterable[str], shown: str) -> Iterator[Token]:
    """Yield the tokens of a file. Raises InputError."""
    for number, line in enumerate(lines, 1):
        place, at = f"{shown}:{number}", 0
        while at < len(line):
            match = _TOKEN.match(line, at)
            if match is None:
                raise InputError.at(place, f'unexpected "{line[at : at + 20].strip()}"')
            if match.lastgroup is not None:
                text = match[match.lastgroup]
                is_escaped = match.lastgroup == "string" and "\\" in text
                yield Token(match.lastgroup, _ESCAPED.sub(r"\1", text) if is_escaped else text, place)
            at = match.end()
