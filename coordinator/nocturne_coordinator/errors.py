"""Every exception that leaves this package; `RejectedResult` and `replay.ReplayMismatch` are caught inside.

`InvalidState` of `dispatch.validation` is raised in tests only.

NocturneError, InputError and NotFound are of `nocturne_scene.errors`.

`FolderGone` of `store.database` is an error of SQLite's as well: who gets over those gets over it.

NocturneError
+-- Conflict        a request id was used before with other content
+-- AmbiguousId     several renders have ids that begin so
+-- BlobsMissing       files of a scene were deleted after it was compiled
+-- WrongState      the render is in a state in which that can't be done
+-- QuotaUsedUp     an owner would have more than it may
+-- AlreadyOwned    another coordinator works on the data folder
+-- QueueInUse      Redis serves the coordinator of another data folder
+-- OwnershipLost   another coordinator took the data folder over; nothing may be committed any more
+-- LeaseLost       another coordinator has the render, or its sums were changed; nothing of it may be written
+-- UnusableFolder  the folder was written by another version, or is damaged
+-- RestoreFailed     there is nothing whole to restore from
+-- UnusableQueue   Redis is set up so that it loses messages
+-- StoreUnavailable   the data folder could not be read or written just now; it is tried again
+-- QueueError      Redis could not be reached, or refused; it is tried again
+-- ObjectStoreUnavailable  the object store can't be reached, or refuses
    +-- ObjectDamaged       its data differ from those that were stored
"""

import shutil
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Self

from nocturne_scene.errors import NocturneError


class Conflict(NocturneError):
    """The request id was used before, with other content."""


class AmbiguousId(NocturneError):
    """The beginning of an id that several have; says which."""


class BlobsMissing(NocturneError):
    """Files of a scene were deleted with another render after it was compiled; compiling again may help."""


class WrongState(NocturneError):
    """The render is in a state in which that can't be done."""


class QuotaUsedUp(NocturneError):
    """An owner would have more than it may."""


class QueueInUse(NocturneError):
    """Redis serves the coordinator of another data folder."""


class AlreadyOwned(NocturneError):
    """Another coordinator works on the data folder."""


class OwnershipLost(NocturneError):
    """Another coordinator took the data folder over; this one must stop without committing."""


class LeaseLost(NocturneError):
    """Another coordinator has the render, or its sums were changed; its state in memory is of no use."""

    def __init__(self, render_id: str) -> None:
        super().__init__(f"{render_id} is not this coordinator's any more")
        self.render_id = render_id


_ROOM = 2**20


def _free(folder: Path) -> int:
    """Bytes on its disk; 0 where it is not there."""
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return 0


class UnusableFolder(NocturneError):
    """The data folder was written by another version of the program, is damaged, or can't be written."""

    @classmethod
    def because(cls, folder: Path, trouble: Exception) -> Self:
        """What the system or SQLite says that passes: no rights, no space, another file in its place."""
        if "full" in str(trouble) and _free(folder) >= _ROOM:
            # Python refuses to name a folder that it can't write to.
            with suppress(FileNotFoundError):
                temporary = Path(tempfile.gettempdir())
                if _free(temporary) < _ROOM:
                    return cls(
                        f"{temporary} is full, where temporary files go ({trouble}): make room, or set TMPDIR"
                    )
        return cls(f"{folder} can't be used ({trouble}); see to its rights and to the space on its disk")


class RestoreFailed(NocturneError):
    """There is nothing whole to restore a data folder from, or nothing that may be replaced."""


class UnusableQueue(NocturneError):
    """Redis is set up so that it loses messages."""


class StoreUnavailable(NocturneError):
    """The data folder could not be read or written just now; the operation is tried again."""


class QueueError(NocturneError):
    """Redis could not be reached, or refused; it is unknown which commands took effect."""


class ObjectStoreUnavailable(NocturneError):
    """The object store can't be reached, or refuses; the same may succeed later."""


class ObjectDamaged(ObjectStoreUnavailable):
    """The object store's data differ from those that were stored."""
