"""Deleting renders: first its rows go, in one transaction; then the files that no other render uses.

Files to remove are noted in that transaction, so that a crash in between leaves none behind: `sweep` may be
called again, by any process, and removes the rest.
"""

import re
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from google.protobuf.message import DecodeError, Message
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import NotFound
from nocturne_scene.replacing import sync

from nocturne_coordinator.errors import WrongState
from nocturne_coordinator.store.data_folder import DataFolder

_ASSET = re.compile(r"sha256:([0-9a-f]{64})")


def blobs_of_scene(blobs: BlobStore, scene_sha256: str) -> tuple[str, ...]:
    """Digests of a compiled scene and of all files that it names. Raises NotFound where it is not there."""
    try:
        scene = scene_pb2.CompiledScene.FromString(blobs.path(scene_sha256).read_bytes())
    except DecodeError:
        return (scene_sha256,)
    return (scene_sha256, *sorted(set(_named_in(scene))))


def _named_in(message: Message) -> Iterator[str]:
    for field, value in message.ListFields():
        if field.name == "blob":
            yield value.hex()
        elif field.message_type is not None:
            for each in (value,) if isinstance(value, Message) else value:
                yield from _named_in(each)


def delete_render(folder: DataFolder, render_id: str) -> None:
    """Forgets a render that has ended, with its sums, history and leases; `sweep` removes its files.

    Raises NotFound, and WrongState for one that has not ended.
    """
    render = folder.renders.get(render_id)
    try:
        of_scene = blobs_of_scene(folder.blobs, render.scene_sha256)
    except NotFound:
        of_scene = ()
    of_document = _ASSET.findall(folder.renders.scene_document(render_id))
    files = sorted({*of_scene, *of_document, render.layers_sha256} - {""})
    with folder.database.transaction():
        state = folder.renders.get(render_id).state
        if not state.ended:
            raise WrongState(f"{render_id} is {state}; cancel it before it is deleted")
        folder.removals.note(render_id, files)
        folder.database.execute("DELETE FROM at_work WHERE render_id = ?", (render_id,))
        # All other tables follow by their foreign keys.
        folder.database.execute("DELETE FROM render WHERE id = ?", (render_id,))


def sweep(folder: DataFolder) -> None:
    """Removes the files of deleted renders, here and in the object store. Raises OSError,
    ObjectStoreUnavailable; the remaining files are removed the next time."""
    for render_id, files in folder.removals.open():
        _remove(folder.root / "images" / render_id)
        _forget_names(folder.root / "images")
        # Who makes a render looks at its files in the transaction that makes it, so this is one too.
        with folder.database.transaction():
            unused = _unused(folder, files)
            for sha256 in unused:
                folder.blobs.remove_here(sha256)
            folder.uploads.forget(unused)
        for sha256 in unused:
            _forget_names(folder.blobs.root / sha256[:2])
        if folder.object_store is not None:
            folder.object_store.delete_all(f"images/{render_id}")
            for sha256 in unused:
                folder.blobs.remove_there(sha256)
        folder.removals.done(render_id)


def _remove(images: Path) -> None:
    """A coordinator that does not know yet may put a picture there meanwhile; it takes that away itself."""
    shutil.rmtree(images, ignore_errors=True)
    if images.exists():
        shutil.rmtree(images, ignore_errors=True)
    if images.exists():
        raise OSError(f"{images} can't be removed")


def _forget_names(folder: Path) -> None:
    """A file removed from the folder does not come back after a power cut, when nobody would look for it."""
    with suppress(FileNotFoundError):
        sync(folder)


def _unused(folder: DataFolder, files: list[str]) -> list[str]:
    """Those of the blobs that no render needs, neither as its scene or layers, nor in its scene, nor in its
    document."""
    left = {
        sha256
        for sha256 in files
        if folder.database.row(
            "SELECT 1 FROM render WHERE ?1 IN (scene_sha256, layers_sha256) OR instr(scene_document, ?1)",
            (sha256,),
        )
        is None
    }
    scenes = folder.database.rows("SELECT DISTINCT scene_sha256 FROM render") if left else []
    for scene in scenes:
        compiled = folder.blobs.here(scene["scene_sha256"])
        if compiled is None:
            # The files it names are not known here.
            return []
        # It names its files by the 32 bytes of their digests.
        data = compiled.read_bytes()
        left = {sha256 for sha256 in left if bytes.fromhex(sha256) not in data}
    return sorted(left)
