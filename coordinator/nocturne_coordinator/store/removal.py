"""Deleting renders: first its rows go, in one transaction; then the files that no other render uses.

Files to remove are noted in that transaction, so that a crash in between leaves none behind: `sweep` may be
called again, by any process, and removes the rest.
"""

import shutil
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from nocturne_scene.replacing import sync

from nocturne_coordinator.errors import WrongState
from nocturne_coordinator.store.data_folder import DataFolder


def delete_render(folder: DataFolder, render_id: str) -> None:
    """Forgets a render that has ended, with its sums, history and leases; `sweep` removes its files.

    Raises NotFound, and WrongState for one that has not ended.
    """
    with folder.database.transaction():
        state = folder.renders.get(render_id).state
        if not state.ended:
            raise WrongState(f"{render_id} is {state}; cancel it before it is deleted")
        files = [sha256 for sha256 in folder.blob_use.of(render_id) if sha256]
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
        unused = _remove_unused_here(folder, files)
        for sha256 in unused:
            _forget_names(folder.blobs.root / sha256[:2])
        if folder.object_store is not None:
            folder.object_store.delete_all(f"images/{render_id}")
            for sha256 in unused:
                folder.blobs.remove_there(sha256)
        folder.removals.done(render_id)


def sweep_unused(folder: DataFolder, seconds: float) -> list[str]:
    """Removes files that no render uses, uploads that nothing came of and scenes whose render was never made,
    when nobody has asked about them for so long; gives their digests. Raises OSError, ObjectStoreUnavailable.
    """
    before = time.time() - seconds
    folder.blobs.remove_unfinished(before)
    gone = _remove_unused_here(folder, folder.blob_use.unused(folder.blobs.older_than(before)))
    for sha256 in gone:
        folder.blobs.remove_there(sha256)
    return gone


def _remove_unused_here(folder: DataFolder, files: Iterable[str]) -> list[str]:
    # Who makes a render looks at its files in the transaction that makes it, so this is one too.
    with folder.database.transaction():
        unused = folder.blob_use.unused(files)
        for sha256 in unused:
            folder.blobs.remove_here(sha256)
        folder.uploads.forget(unused)
    return unused


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
