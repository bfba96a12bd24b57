"""A scene on disk: its document, and the files that it names by relative paths."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from nocturne_client import overlays
from nocturne_client.errors import NocturneClientError, Problem

DIGEST_PREFIX = "sha256:"
_READ_BYTES = 1024 * 1024
# The service refuses longer documents; there is no point in reading one.
_DOCUMENT_BYTES = 8 * 1024 * 1024
_MOST_OVERLAYS = 8
"""One over the other."""


@dataclass(frozen=True)
class SceneOnDisk:
    """A scene document that names its files by digest, and where those files are."""

    document: dict[str, Any]
    files: dict[str, Path]
    """By SHA-256, lower-case hexadecimal."""

    @property
    def name(self) -> str:
        """The document's own name; empty where it has none."""
        name = self.document.get("name")
        return name if isinstance(name, str) else ""


def read_scene(path: Path) -> SceneOnDisk:
    """Reads the scene document at `path` and replaces relative paths of assets by digests.

    A path must stay inside the document's folder. A mesh's extension becomes its `format` if it has none.
    Of an overlay it is the whole scene: its base with the overlay's changes (`nocturne_client.overlays`).
    Raises NocturneClientError that names every path that can't be used, and every name of an overlay that
    its base does not have.
    """
    return _read(path, _MOST_OVERLAYS)


def _read(path: Path, most_overlays: int) -> SceneOnDisk:
    document = _read_document(path)
    above = _with_digests(path, document)
    if not overlays.is_overlay(document):
        return above
    base = _read(_base(path, document["base"], most_overlays), most_overlays - 1)
    made, problems = overlays.laid_over(base.document, above.document)
    if problems:
        raise NocturneClientError(f"{path} does not fit its base, {document['base']}", problems=problems)
    return SceneOnDisk(made, {**base.files, **above.files})


def _base(overlay: Path, base: Any, most_overlays: int) -> Path:
    """The document that an overlay is laid over. Raises NocturneClientError."""
    if not isinstance(base, str):
        said = "expected the path of a scene document"
    elif is_of_other_renderer(Path(base)):
        said = f"{base} is no scene document; make one by `nocturne import {base} -o FOLDER`"
    elif most_overlays == 0:
        said = f"more than {_MOST_OVERLAYS} overlays, one over the other"
    else:
        try:
            return _resolve(overlay.parent, base)
        except (OSError, ValueError) as error:
            said = f"{base}: {_reason(error)}"
    raise NocturneClientError(f"{overlay} can't be read", problems=[Problem("$.base", said)])


def _with_digests(path: Path, document: dict[str, Any]) -> SceneOnDisk:
    files: dict[str, Path] = {}
    problems: list[Problem] = []
    for place, part in _parts_with_paths(document):
        try:
            file = _resolve(path.parent, part["asset"])
            sha256 = digest(file)
        except (OSError, ValueError) as error:
            problems.append(Problem(place, f"{part['asset']}: {_reason(error)}"))
            continue
        if part.get("type") == "mesh":
            part.setdefault("format", file.suffix.removeprefix(".").lower())
        part["asset"] = DIGEST_PREFIX + sha256
        files[sha256] = file
    if problems:
        raise NocturneClientError(f"{path}: files are missing{_maker(path.parent)}", problems=problems)
    return SceneOnDisk(document, files)


def with_year(scene: SceneOnDisk, weather: Path) -> SceneOnDisk:
    """The scene, whose meters measure the daylight of a year. Raises NocturneClientError."""
    sensor = scene.document.get("sensor")
    if not isinstance(sensor, dict) or sensor.get("type") != "meters":
        raise NocturneClientError('daylight of a year is that of meters: "sensor": {"type": "meters", ...}')
    try:
        sha256 = digest(weather)
    except OSError as error:
        raise NocturneClientError(f"{weather}: {_reason(error)}") from error
    told = sensor.get("daylight")
    daylight = {"of": "sky", **(told if isinstance(told, dict) else {})}
    daylight["weather"] = {"asset": DIGEST_PREFIX + sha256}
    document = {**scene.document, "sensor": {**sensor, "daylight": daylight}}
    return SceneOnDisk(document, {**scene.files, sha256: weather})


OTHER_RENDERERS = (".xml", ".pbrt", ".pbrt.gz", ".gltf", ".glb", ".rad", ".obj", ".zip")
"""How files of scenes end that are imported."""


def is_of_other_renderer(scene: Path) -> bool:
    """Whether a scene is to be imported."""
    return scene.name.lower().endswith(OTHER_RENDERERS)


def digest(file: Path) -> str:
    """SHA-256 of a file, lower-case hexadecimal."""
    found = hashlib.sha256()
    with file.open("rb") as stream:
        while piece := stream.read(_READ_BYTES):
            found.update(piece)
    return found.hexdigest()


def _read_document(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _DOCUMENT_BYTES:
            raise NocturneClientError(
                f"{path}: a scene document has at most 8 MiB; put meshes into files beside it"
            )
        document = json.loads(path.read_bytes())
    except OSError as error:
        raise NocturneClientError(f"{path}: {_reason(error)}{_maker(path.parent)}") from error
    except RecursionError as error:
        raise NocturneClientError(f"{path}: nested too deep") from error
    except ValueError as error:
        raise NocturneClientError(f"{path}: not JSON: {error}") from error
    if not isinstance(document, dict):
        raise NocturneClientError(f"{path}: expected a JSON object")
    return document


def _maker(folder: Path) -> str:
    """How to make the files of a scene that is generated: by the programs `make_*.py` in its folder."""
    programs = " and ".join(f"`python {program}`" for program in sorted(folder.glob("make_*.py")))
    return f"; make what is missing by {programs}" if programs else ""


def _parts_with_paths(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Objects whose field "asset" is a path, with its place. The malformed is left for the service to report.

    Wherever a document names a file, it does so by a field of that name. Without recursion, for any depth.
    """
    waiting: list[tuple[str, Any]] = [("$", document)]
    while waiting:
        place, value = waiting.pop()
        if isinstance(value, dict):
            asset = value.get("asset")
            if isinstance(asset, str) and not asset.startswith(DIGEST_PREFIX):
                yield f"{place}.asset", value
            # In a sensor's responses, people choose the keys and values are names.
            inside = ((key, inner) for key, inner in reversed(value.items()) if key != "responses")
            waiting.extend((place + _step(key), inner) for key, inner in inside)
        elif isinstance(value, list) and not _is_numbers(value):
            indexed = reversed(list(enumerate(value)))
            waiting.extend((f"{place}[{index}]", inner) for index, inner in indexed)


def _step(key: str) -> str:
    return f".{key}" if key.isidentifier() else f"[{json.dumps(key)}]"


def _is_numbers(values: list[Any]) -> bool:
    """Whether a list is a point or a triangle, as most lists of a document are."""
    return bool(values) and isinstance(values[0], int | float)


def _resolve(folder: Path, asset: str) -> Path:
    """The file; raises ValueError for a path that leads out of `folder`, by itself or by a link."""
    relative = PurePosixPath(asset)
    if relative.is_absolute() or ".." in relative.parts:
        raise ValueError("expected a path relative to the scene document, without `..`")
    file = (folder / relative).resolve()
    if not file.is_relative_to(folder.resolve()):
        raise ValueError("leads out of the scene document's folder")
    if not file.is_file():
        raise FileNotFoundError(2, "no such file")
    return file


def _reason(error: Exception) -> str:
    return error.strerror or str(error) if isinstance(error, OSError) else str(error)
