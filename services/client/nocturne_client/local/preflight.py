"""`nocturne preflight`: the pilot of a scene on this disk."""

import tempfile
from copy import deepcopy
from pathlib import Path

from nocturne_scene.blobs import BlobStore
from nocturne_scene.simplify.search import Preflight, Request, Say, run_preflight
from nocturne_scene.simplify.simplification import Document, objects

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import store_files
from nocturne_client.local.failures import client_errors
from nocturne_client.scene_files import DIGEST_PREFIX, SceneOnDisk


def preflight_of(request: Request, scene: SceneOnDisk, say: Say) -> Preflight:
    """Run the pilot. Raises NocturneClientError."""
    with (
        client_errors("the scene's needs can't be found"),
        tempfile.TemporaryDirectory(prefix="nocturne-preflight-") as folder,
    ):
        store_files(scene, BlobStore(Path(folder) / "blobs", durable=False))
        return run_preflight(request, scene.document, Path(folder), say)


def taken(scene: SceneOnDisk, document: Document, file: Path) -> Document:
    """The document with paths where it has digests, to be written as `file`.

    Raises NocturneClientError if the scene's files are not in that file's folder.
    """
    folder = file.absolute().parent.resolve()
    if not folder.is_dir():
        raise NocturneClientError(f"{folder}: no such folder")
    paths = {}
    for sha256, path in scene.files.items():
        if not path.is_relative_to(folder):
            raise NocturneClientError(
                f"{file}: a scene's files must be in its document's folder, and {path.name} is not; "
                f"expected a file in {path.parent}"
            )
        paths[DIGEST_PREFIX + sha256] = path.relative_to(folder).as_posix()
    copy = deepcopy(document)
    for each in objects(copy):
        asset = each.get("asset")
        if isinstance(asset, str):
            each["asset"] = paths.get(asset, asset)
    return copy
