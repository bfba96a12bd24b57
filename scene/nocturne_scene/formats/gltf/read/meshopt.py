"""Buffer views that are compressed by meshoptimizer (EXT_meshopt_compression, KHR_meshopt_compression)."""

from typing import Any

from nocturne_scene.errors import InputError
from nocturne_scene.limits import MAX_ASSET_BYTES

Json = Any

NAMES = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTERS = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")


def compressed(view: Json) -> Json | None:
    """What a buffer view says of its compressed form; None where it has none."""
    extensions = view.get("extensions")
    if not isinstance(extensions, dict):
        return None
    return next((extensions[name] for name in NAMES if isinstance(extensions.get(name), dict)), None)


def decompress(extension: Json, content: bytes, count: int, stride: int, shown: str) -> bytes:
    """Return `count` rows of `stride` bytes of a buffer view that `shown` names. Raises InputError."""
    # Few files need it.
    import meshopt

    mode, filtered = extension.get("mode"), extension.get("filter", "NONE")
    if mode not in _MODES or filtered not in _FILTERS:
        raise InputError.at(shown, f"no compressed form {str(mode)[:20]} with filter {str(filtered)[:20]}")
    if not 0 < count * stride <= MAX_ASSET_BYTES:
        raise InputError.at(shown, f"{count} rows of {stride} bytes are none, or too many")
    try:
        return bytes(meshopt.decode_gltf_buffer(content, count, stride, mode, filtered).tobytes())
    except Exception as error:  # of its native part, without a base
        raise InputError.at(shown, f"its meshopt data can't be read: {str(error)[:100]}") from None
