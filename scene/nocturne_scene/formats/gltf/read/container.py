"""Files: the JSON tree, the buffers, and numbers out of them. Every count is checked before it is used."""

import base64
import binascii
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read import form, meshopt
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES, SceneFiles, read_bytes
from nocturne_scene.limits import MAX_ASSET_BYTES
from nocturne_scene.meshes import glb

Json = Any

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# Of normalised whole numbers.
_LARGEST = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}

# Numbers of one accessor: the triangles of the largest mesh.
_MAX_NUMBERS = 2**29
# Of one that takes no bytes in the file; half a GiB.
_MAX_ZEROS = 2**26


@dataclass
class Container:
    """One scene's JSON and binary parts."""

    tree: dict[str, Json]
    files: SceneFiles
    folder: Path
    shown: str
    chunk: bytes = b""
    decoded: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    """Values of accessors, as they are stored, that were compressed."""
    _buffers: dict[int, bytes] = field(default_factory=dict)
    _decompressed: dict[int, bytes] = field(default_factory=dict)

    def item(self, kind: str, index: Json, place: str) -> dict[str, Json]:
        """An entry of one of the tree's lists. Raises InputError."""
        entries = self.tree.get(kind, [])
        if not isinstance(entries, list) or not isinstance(index, int) or isinstance(index, bool):
            raise InputError.at(self.at(place), f"expected an index into {kind}")
        if not 0 <= index < len(entries) or not isinstance(entries[index], dict):
            raise InputError.at(self.at(place), f"there is no {kind}[{index}]; the file has {len(entries)}")
        found: dict[str, Json] = entries[index]
        return found

    def at(self, place: str) -> str:
        """A place in the file, for messages."""
        return f"{self.shown}: {place}"

    def numbers(self, index: Json, place: str, *types: str) -> NDArray[np.float64]:
        """An accessor's values, shape (count, width). Raises InputError."""
        accessor = self.item("accessors", index, place)
        place = f"accessors[{index}]"
        kind, component = accessor.get("type"), accessor.get("componentType")
        if kind not in types or component not in _COMPONENTS:
            raise InputError.at(self.at(place), f"expected {' or '.join(types)} of a known component type")
        count, width = self.count(accessor, "count", place), _WIDTHS[kind]
        if count * width > _MAX_NUMBERS:
            raise InputError.at(self.at(place), f"{count} values are too many")
        if index in self.decoded:
            values = self.decoded[index].copy()
            if values.shape != (count, width):
                raise InputError.at(self.at(place), "has another size than its compressed values")
        elif "bufferView" in accessor:
            values = self._rows(accessor, component, count, width, place)
        elif count * width > _MAX_ZEROS:
            raise InputError.at(self.at(place), f"{count} zeros are too many")
        else:
            # glTF 2.0, section 3.6.2.3: an accessor without a buffer view is zeros, but for its sparse part.
            values = np.zeros((count, width))
        if "sparse" in accessor:
            values = self._replaced(values, accessor["sparse"], component, place)
        if accessor.get("normalized") and component in _LARGEST:
            values = np.maximum(values / _LARGEST[component], -1.0)
        if not np.all(np.isfinite(values)):
            raise InputError.at(self.at(place), "holds values that are not finite")
        return values

    def _rows(self, entry: Json, component: int, count: int, width: int, place: str) -> NDArray[np.float64]:
        """Values in a buffer view, as an accessor or a part of one says."""
        item = np.dtype(_COMPONENTS[component])
        row = item.itemsize * width
        view, stride = self._view(entry.get("bufferView"), place)
        stride = stride or row
        start = self.count(entry, "byteOffset", place, 0)
        if stride < row or (count and start + stride * (count - 1) + row > len(view)):
            raise InputError.at(self.at(place), "reaches beyond its buffer view")
        if not count:
            return np.zeros((0, width))
        return np.array(
            np.ndarray((count, width), item, view, start, (stride, item.itemsize)), dtype=np.float64
        )

    def _replaced(
        self, values: NDArray[np.float64], sparse: Json, component: int, place: str
    ) -> NDArray[np.float64]:
        """The values of an accessor with those that its sparse part replaces."""
        place = f"{place}.sparse"
        if not isinstance(sparse, dict):
            raise InputError.at(self.at(place), "expected an object")
        parts = [sparse.get(name) for name in ("indices", "values")]
        kind = parts[0].get("componentType") if isinstance(parts[0], dict) else None
        if kind not in _COMPONENTS or not isinstance(parts[1], dict):
            raise InputError.at(self.at(place), 'expected "indices" and "values"')
        count = self.count(sparse, "count", place)
        if count > len(values):
            raise InputError.at(self.at(place), "replaces more values than there are")
        where = self._rows(parts[0], kind, count, 1, place).ravel().astype(np.int64)
        if count and not 0 <= where.min() <= where.max() < len(values):
            raise InputError.at(self.at(place), "replaces values that are not there")
        values[where] = self._rows(parts[1], component, count, values.shape[1], place)
        return values

    def image(self, index: Json, place: str) -> tuple[bytes, str]:
        """An image's bytes and the end of a name for them. Raises InputError."""
        image = self.item("images", index, place)
        if "bufferView" in image:
            view, _ = self._view(image["bufferView"], place)
            return bytes(view), {"image/png": ".png", "image/jpeg": ".jpg"}.get(
                str(image.get("mimeType")), ".img"
            )
        uri = image.get("uri")
        content = self._uri(uri, f"images[{index}]")
        end = ".jpg" if content[:2] == b"\xff\xd8" else ".png"
        return content, end

    def count(self, entry: dict[str, Json], key: str, place: str, default: int | None = None) -> int:
        """A whole number that is not negative. Raises InputError."""
        value = entry.get(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
            raise InputError.at(self.at(place), f'"{key}" is a whole number, not negative')
        return value

    def view(self, index: Json, place: str) -> memoryview:
        """The bytes of a buffer view. Raises InputError."""
        return self._view(index, place)[0]

    def _view(self, index: Json, place: str) -> tuple[memoryview, int]:
        view = self.item("bufferViews", index, place)
        place = f"bufferViews[{index}]"
        extension = meshopt.compressed(view)
        if extension is None:
            return self._part(view, place), self.count(view, "byteStride", place, 0)
        count, stride = (self.count(extension, name, place) for name in ("count", "byteStride"))
        if index not in self._decompressed:
            content = bytes(self._part(extension, place))
            self._decompressed[index] = meshopt.decompress(extension, content, count, stride, self.at(place))
        return memoryview(self._decompressed[index]), stride

    def _part(self, entry: Json, place: str) -> memoryview:
        """The bytes of a buffer that an entry names."""
        content = self._buffer(entry.get("buffer"), place)
        start, length = self.count(entry, "byteOffset", place, 0), self.count(entry, "byteLength", place)
        if start + length > len(content):
            raise InputError.at(self.at(place), "reaches beyond its buffer")
        return memoryview(content)[start : start + length]

    def _buffer(self, index: Json, place: str) -> bytes:
        buffer = self.item("buffers", index, place)
        if index not in self._buffers:
            uri = buffer.get("uri")
            content = self.chunk if uri is None and index == 0 else self._uri(uri, f"buffers[{index}]")
            self._buffers[index] = content
        return self._buffers[index]

    def _uri(self, uri: Json, place: str) -> bytes:
        if not isinstance(uri, str):
            raise InputError.at(self.at(place), 'expected "uri"')
        if uri.startswith("data:"):
            head, comma, body = uri.partition(",")
            if not comma or not head.endswith(";base64"):
                raise InputError.at(self.at(place), "a data URI is in base64")
            try:
                return base64.b64decode(body, validate=True)
            except (binascii.Error, ValueError):
                raise InputError.at(self.at(place), "a data URI is no base64") from None
        file = self.files.find(unquote(uri), [self.folder], self.at(place))
        return read_bytes(file, MAX_ASSET_BYTES, self.files.shown(file))


def open_container(file: Path, root: Path) -> Container:
    """Read a .gltf or .glb file. Raises InputError."""
    files = SceneFiles(root)
    shown = files.shown(file)
    chunk = b""
    if file.suffix.lower() == ".glb":
        text, chunk = _glb(read_bytes(file, MAX_ASSET_BYTES, shown), shown)
    else:
        text = read_bytes(file, TEXT_BYTES, shown)
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError.at(shown, f"holds no JSON: {str(error)[:200]}") from None
    asset = tree.get("asset") if isinstance(tree, dict) else None
    if not isinstance(asset, dict) or not str(asset.get("version", "")).startswith("2."):
        raise InputError.at(shown, "is no glTF 2.0")
    form.check(tree, shown)
    return Container(tree, files, file.parent, shown, chunk)


def _glb(content: bytes, shown: str) -> tuple[bytes, bytes]:
    try:
        return glb.parts(content)
    except ValueError as error:
        raise InputError.at(shown, str(error)) from None


def value(entry: Json, key: str, default: Json) -> Json:
    """A field of an object of any kind."""
    return entry.get(key, default) if isinstance(entry, dict) else default


def floats(container: Container, entry: Json, key: str, default: list[float], place: str) -> list[float]:
    """A list of finite numbers as long as `default`. Raises InputError."""
    found = value(entry, key, default)
    right = isinstance(found, list) and len(found) == len(default)
    if not right or not all(isinstance(each, int | float) and abs(each) < 1e30 for each in found):
        raise InputError.at(container.at(place), f'"{key}" is {len(default)} numbers')
    return [float(each) for each in found]


def number(container: Container, entry: Json, key: str, default: float, place: str) -> float:
    """A finite number. Raises InputError."""
    return floats(container, {key: [value(entry, key, default)]}, key, [default], place)[0]


def unused_extensions(entry: Json, known: tuple[str, ...], findings: Findings, place: str) -> None:
    """Report extensions of an object that have no counterpart."""
    for name in value(entry, "extensions", {}):
        if name not in known:
            findings.lost(place, f"no support for the extension {name}")
