"""Imports one scene: the job on standard input, the answer on standard output, both JSON.

Files of the scene are copied below the job's folder, to the paths that they have for each other.
"""

import hashlib
import json
import os
import resource
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError, NocturneError, NotFound
from nocturne_scene.formats import archives
from nocturne_scene.formats.import_scene import ENDS, import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from nocturne_api.limits import IMPORT_BYTES, IMPORT_CPU_S, IMPORT_MEMORY_BYTES

_DIGEST = "sha256:"


def main() -> None:
    """Reads the job, imports the scene, writes the answer."""
    job = json.load(sys.stdin)
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (IMPORT_MEMORY_BYTES, IMPORT_MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (IMPORT_CPU_S, IMPORT_CPU_S))
    resource.setrlimit(resource.RLIMIT_FSIZE, (IMPORT_BYTES, IMPORT_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        answer = _imported(job, Path(job["folder"]))
    except InputError as error:
        answer = {"problems": [[each.place, each.message] for each in error.problems]}
    except MemoryError:
        answer = {"problems": [["$.files", f"need more than {IMPORT_MEMORY_BYTES} bytes of memory"]]}
    except NocturneError as error:
        answer = {"problems": [["$.files", str(error)]]}
    except OSError as error:
        answer = {"problems": [["$.files", f"can't be imported: {error.strerror}"]]}
    json.dump(answer, sys.stdout)


def _imported(job: dict[str, Any], folder: Path) -> dict[str, Any]:
    root, out = folder / "files", folder / "scene"
    root.mkdir()
    _bring(job["files"], BlobStore(Path(job["blobs"]), _objects(job["objects"])), root)
    name = job["scene"] or archives.scene_among(job["files"], ENDS, "$.files", root)
    if name not in job["files"]:
        raise InputError.at("$.scene", f'"{name[:100]}" is not among the files')
    light = job["light"]
    if light in job["files"]:
        light = str(root / light)
    elif light not in ("", "sky", "studio"):
        raise InputError.at("$.light", "expected sky, studio or the path of one of the files")
    options = ImportOptions(
        root=root,
        parameters=job["parameters"],
        light=light or None,
        time=job["time"],
        allow_missing=job["allow_missing"],
    )
    try:
        imported = import_scene(root / name, out, options)
    except InputError as error:
        # Places are paths of files, of which the caller knows those below the root.
        raise InputError(
            type(each)(each.place.replace(f"{root}/", ""), each.message.replace(f"{root}/", ""))
            for each in error.problems
        ) from None
    document = json.loads(imported.document.read_text())
    files = {digest: str(file) for digest, file in _named(document, out)}
    return {
        "document": document,
        "scene": name,
        "width": imported.film.width,
        "height": imported.film.height,
        "samples": imported.film.samples,
        "notes": [note.replace(f"{root}/", "") for note in imported.notes],
        "missing": [
            {"place": each.place.replace(f"{root}/", ""), "message": each.message}
            for each in imported.missing
        ],
        "files": files,
    }


def _objects(url: str | None) -> ObjectStore | None:
    return ObjectStore(url) if url else None


def _bring(files: dict[str, str], blobs: BlobStore, root: Path) -> None:
    """Copy uploaded files to their paths."""
    left = IMPORT_BYTES
    for name, sha256 in files.items():
        archives.check_path(name, "$.files")
        try:
            source = blobs.path(sha256)
        except (NotFound, InputError) as error:
            raise InputError.at("$.files", str(error)) from None
        left -= source.stat().st_size
        if left < 0:
            raise InputError.at("$.files", f"have more than {IMPORT_BYTES} bytes together")
        try:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, root / name)
        except (FileExistsError, NotADirectoryError, IsADirectoryError):
            raise InputError.at("$.files", f'"{name[:100]}" is a file and a folder') from None


def _named(document: Any, folder: Path) -> Iterator[tuple[str, Path]]:
    """Replace paths in a document by digests; give both."""
    waiting = [document]
    while waiting:
        part = waiting.pop()
        if isinstance(part, list):
            waiting.extend(each for each in part if isinstance(each, dict | list))
        elif isinstance(part, dict):
            waiting.extend(part.values())
            asset = part.get("asset")
            if isinstance(asset, str) and not asset.startswith(_DIGEST):
                file = folder / asset
                with file.open("rb") as stream:
                    digest = hashlib.file_digest(stream, "sha256").hexdigest()
                if part.get("type") == "mesh":
                    part.setdefault("format", file.suffix.removeprefix(".").lower())
                part["asset"] = _DIGEST + digest
                yield digest, file


if __name__ == "__main__":
    main()
