"""The container of a .glb file: a header, the JSON of a glTF, and one chunk of bytes.

glTF 2.0 specification, section 4.4: all numbers are uint32, little endian.
"""

import struct

HEADER_BYTES = 20
"""Of the file and of its first chunk, which is the JSON."""

_JSON, _BINARY = 0x4E4F534A, 0x004E4942


def json_length(head: bytes) -> int:
    """Bytes of JSON after the header, as the header says. Raises ValueError where it is none of version 2."""
    if len(head) < HEADER_BYTES or head[:4] != b"glTF":
        raise ValueError("is no GLB file")
    version, _, length, kind = struct.unpack_from("<IIII", head, 4)
    if version != 2 or kind != _JSON:
        raise ValueError("is no GLB file of version 2")
    return int(length)


def parts(content: bytes) -> tuple[bytes, bytes]:
    """The JSON and the binary chunk, empty where there is none. Raises ValueError."""
    end = HEADER_BYTES + json_length(content)
    if end > len(content):
        raise ValueError("is a GLB file that is cut short")
    text, rest = content[HEADER_BYTES:end], content[end:]
    if len(rest) < 8:
        return text, b""
    size, kind = struct.unpack_from("<II", rest)
    if kind != _BINARY or 8 + size > len(rest):
        raise ValueError("is a GLB file whose binary chunk is damaged")
    return text, rest[8 : 8 + size]
