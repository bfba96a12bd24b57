"""Files that no render uses: uploads that nothing came of, scenes whose render was never made.

They go when they have been there for a while, without a question about them.
"""

import re
import time
from collections.abc import Iterator

from nocturne_scene.errors import NotFound

from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.removal import blobs_of_scene

_ASSET = re.compile(r"sha256:([0-9a-f]{64})")
_AT_ONCE = 100


def sweep_unused(folder: DataFolder, seconds: float) -> list[str]:
    """Removes files that are older than `seconds` and that no render uses; gives their digests.

    Where a render's scene is not on this machine its assets are unknown, and nothing is removed. Raises
    OSError, ObjectStoreUnavailable.
    """
    before = time.time() - seconds
    folder.blobs.remove_unfinished(before)
    old = set(folder.blobs.older_than(before))
    try:
        newest = 0
        for number, files in _in_use(folder, 0):
            newest = number
            old -= files
        if not old:
            return []
        # Who makes a render looks at its files in the transaction that makes it, so this is one too.
        with folder.database.transaction():
            for _, files in _in_use(folder, newest):
                old -= files
            for sha256 in old:
                folder.blobs.remove_here(sha256)
            folder.uploads.forget(old)
    except NotFound:
        return []
    for sha256 in sorted(old):
        folder.blobs.remove_there(sha256)
    return sorted(old)


def _in_use(folder: DataFolder, after: int) -> Iterator[tuple[int, set[str]]]:
    """Of each render above a number: its own, and what its document, its scene and that one's parts name."""
    known: dict[str, set[str]] = {}
    while rows := folder.database.rows(
        """SELECT number, scene_sha256, layers_sha256, scene_document FROM render
           WHERE number > ? ORDER BY number LIMIT ?""",
        (after, _AT_ONCE),
    ):
        for row in rows:
            scene = str(row["scene_sha256"])
            if scene not in known:
                known[scene] = set(blobs_of_scene(folder.blobs, scene))
            of_document = _ASSET.findall(row["scene_document"])
            yield int(row["number"]), known[scene] | {row["layers_sha256"], *of_document}
        after = int(rows[-1]["number"])
