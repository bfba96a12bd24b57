"""A scene on disk: its document, and the files that it names by relative paths."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from nocturne_client.errors import NocturneClientError, Problem

DIGEST_PREFIX = "sha256:"
_READ_BYTES = 1024 * 1024
# The service refuses longer documents; there is no point in reading one.
_DOCUMENT_BYTES = 8 * 1024 * 1024


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

    A path must stay inside the document's folder. The extension becomes the asset's `format` if it has none.
    Raises NocturneClientError that names every path that can't be used.
    """
    document = _read_document(path)
    files: dict[str, Path] = {}
    problems: list[Problem] = []
    for place, shape in _shapes_with_paths(document):
        try:
            file = _resolve(path.parent, shape["asset"])
            sha256 = digest(file)
        except (OSError, ValueError) as error:
            problems.append(Problem(place, f"{shape['asset']}: {_reason(error)}"))
            continue
        shape.setdefault("format", file.suffix.removeprefix(".").lower())
        shape["asset"] = DIGEST_PREFIX + sha256
        files[sha256] = file
    if problems:
        raise NocturneClientError(f"{path}: files are missing", problems=problems)
    return SceneOnDisk(document, files)


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
        raise NocturneClientError(f"{path}: {_reason(error)}") from error
    except RecursionError as error:
        raise NocturneClientError(f"{path}: nested too deep") from error
    except ValueError as error:
        raise NocturneClientError(f"{path}: not JSON: {error}") from error
    if not isinstance(document, dict):
        raise NocturneClientError(f"{path}: expected a JSON object")
    return document


def _shapes_with_paths(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Shapes whose asset is a path, with their places. The malformed is left for the service to report."""
    surfaces = document.get("surfaces")
    for index, surface in enumerate(surfaces if isinstance(surfaces, list) else []):
        shape = surface.get("shape") if isinstance(surface, dict) else None
        asset = shape.get("asset") if isinstance(shape, dict) else None
        if isinstance(shape, dict) and isinstance(asset, str) and not asset.startswith(DIGEST_PREFIX):
            yield f"$.surfaces[{index}].shape.asset", shape


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
