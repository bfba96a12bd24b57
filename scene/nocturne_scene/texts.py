"""Text of scenes from any system: UTF-8, with single bytes of Latin-1 in between, or UTF-16 that says so."""

import codecs
import io
from typing import BinaryIO

_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_ERRORS = "nocturne.latin-1"


def _as_latin_1(error: UnicodeError) -> tuple[str, int]:
    """Decode bytes that are no UTF-8 one by one; for UTF-16 there is nothing to take instead."""
    if not isinstance(error, UnicodeDecodeError) or not error.encoding.startswith("utf-8"):
        raise error
    return error.object[error.start : error.end].decode("latin-1"), error.end


codecs.register_error(_ERRORS, _as_latin_1)


def text_of(binary: BinaryIO) -> io.TextIOWrapper:
    """A file as text whose lines end in LF: from LF, CR LF or CR, without a byte order mark.

    Reading raises UnicodeError where UTF-16 is cut off or has half a character.
    """
    start = binary.read(2)
    binary.seek(0)
    encoding = "utf-16" if start in _UTF_16 else "utf-8-sig"
    return io.TextIOWrapper(binary, encoding=encoding, errors=_ERRORS)
