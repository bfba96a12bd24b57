"""What kind of JSON each part of a glTF 2.0 file is, as far as it is read."""

from typing import Any

from nocturne_scene.errors import InputError

# A dictionary is an object: its fields have these kinds where they are there, others may be anything; "*" are
# all fields that are not named. A list of one is an array of that kind. float is any number.
_NUMBERS, _INDICES, _NAMES = [float], [int], [str]
_OBJECTS: Any = {"*": {}}
_ATTRIBUTES = {"*": int}
_PLACED = {
    "KHR_texture_transform": {"offset": _NUMBERS, "scale": _NUMBERS, "rotation": float, "texCoord": int}
}
_TEXTURE = {"index": int, "texCoord": int, "scale": float, "extensions": _PLACED | _OBJECTS}
_COLOURED = {
    "baseColorFactor": _NUMBERS,
    "baseColorTexture": _TEXTURE,
    "metallicFactor": float,
    "roughnessFactor": float,
    "metallicRoughnessTexture": _TEXTURE,
}
_PACKED = dict.fromkeys(("buffer", "byteOffset", "byteLength", "byteStride", "count"), int)
_PRIMITIVE = {
    "attributes": _ATTRIBUTES,
    "indices": int,
    "material": int,
    "mode": int,
    "targets": [_ATTRIBUTES],
    "extensions": {"KHR_draco_mesh_compression": {"bufferView": int, "attributes": _ATTRIBUTES}} | _OBJECTS,
}
_LAMP = {
    "type": str,
    "color": _NUMBERS,
    "intensity": float,
    "range": float,
    "spot": {"innerConeAngle": float, "outerConeAngle": float},
}

FORM: dict[str, Any] = {
    "accessors": [
        {
            "bufferView": int,
            "byteOffset": int,
            "componentType": int,
            "count": int,
            "type": str,
            "normalized": bool,
            "sparse": {
                "count": int,
                "indices": {"bufferView": int, "byteOffset": int, "componentType": int},
                "values": {"bufferView": int, "byteOffset": int},
            },
        }
    ],
    "animations": [
        {
            "channels": [{"sampler": int, "target": {"node": int, "path": str, "extensions": _OBJECTS}}],
            "samplers": [{"input": int, "output": int, "interpolation": str}],
        }
    ],
    "asset": {"version": str},
    "buffers": [{"uri": str, "byteLength": int, "extensions": _OBJECTS}],
    "bufferViews": [
        {
            "buffer": int,
            "byteOffset": int,
            "byteLength": int,
            "byteStride": int,
            "extensions": {
                name: _PACKED | {"mode": str, "filter": str}
                for name in ("EXT_meshopt_compression", "KHR_meshopt_compression")
            }
            | _OBJECTS,
        }
    ],
    "cameras": [
        {
            "type": str,
            "perspective": {"yfov": float, "aspectRatio": float},
            "orthographic": {"xmag": float, "ymag": float},
        }
    ],
    "extensions": {"KHR_lights_punctual": {"lights": [_LAMP]}} | _OBJECTS,
    "extensionsRequired": _NAMES,
    "extensionsUsed": _NAMES,
    "images": [{"uri": str, "mimeType": str, "bufferView": int}],
    "materials": [
        {
            "pbrMetallicRoughness": _COLOURED,
            "normalTexture": _TEXTURE,
            "occlusionTexture": _TEXTURE,
            "emissiveTexture": _TEXTURE,
            "emissiveFactor": _NUMBERS,
            "alphaMode": str,
            "alphaCutoff": float,
            "doubleSided": bool,
            "extensions": _OBJECTS,
        }
    ],
    "meshes": [{"primitives": [_PRIMITIVE], "weights": _NUMBERS}],
    "nodes": [
        {
            "camera": int,
            "children": _INDICES,
            "skin": int,
            "matrix": _NUMBERS,
            "mesh": int,
            "rotation": _NUMBERS,
            "scale": _NUMBERS,
            "translation": _NUMBERS,
            "weights": _NUMBERS,
            "extensions": {
                "KHR_lights_punctual": {"light": int},
                "EXT_mesh_gpu_instancing": {"attributes": _ATTRIBUTES},
            }
            | _OBJECTS,
        }
    ],
    "samplers": [{"magFilter": int, "minFilter": int, "wrapS": int, "wrapT": int}],
    "scene": int,
    "scenes": [{"nodes": _INDICES}],
    "skins": [{"inverseBindMatrices": int, "joints": _INDICES}],
    "textures": [{"sampler": int, "source": int, "extensions": {"*": {"source": int}}}],
}

_CALLED = {int: "an integer", float: "a number", str: "a text", bool: "true or false"}


def check(found: Any, shown: str, wanted: Any = FORM, place: str = "") -> None:
    """Raise InputError for the first part that is of another kind; `shown`: the file's name."""
    if isinstance(wanted, dict):
        if not isinstance(found, dict):
            raise InputError.at(f"{shown}: {place}", "expected an object")
        for name, part in found.items():
            kind = wanted.get(name, wanted.get("*"))
            if kind is not None:
                check(part, shown, kind, f"{place}.{name}" if place else name)
    elif isinstance(wanted, list):
        if not isinstance(found, list):
            raise InputError.at(f"{shown}: {place}", "expected an array")
        for number, part in enumerate(found):
            check(part, shown, wanted[0], f"{place}[{number}]")
    elif not _is(found, wanted):
        raise InputError.at(f"{shown}: {place}", f"expected {_CALLED[wanted]}")


def _is(found: Any, kind: type) -> bool:
    if kind is float:
        return isinstance(found, int | float) and not isinstance(found, bool)
    # True is an integer to Python.
    return type(found) is kind
