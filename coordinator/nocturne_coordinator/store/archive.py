"""Which finished images are in the object store, and which are to go there.

A trigger notes a render whose images are final, in the transaction that makes them so.
"""

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from nocturne_coordinator.store.database import Database


@dataclass(frozen=True, slots=True)
class Archived:
    """A file as it went into the object store."""

    sha256: str
    size_bytes: int

    def name(self, render_id: str, file: str) -> str:
        """Its name there: another content has another name."""
        return f"images/{render_id}/{self.sha256}/{file}"


class Archive:
    """The images of a data folder that are in the object store. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def take_due(self, lease_seconds: float) -> str | None:
        """A render whose images are to be copied now; no other process gets it for `lease_seconds`."""
        now = time.time()
        if not self._database.row("SELECT 1 FROM archive WHERE due <= ?", (now,)):
            return None
        with self._database.transaction():
            row = self._database.row(
                "SELECT render_id FROM archive WHERE due <= ? ORDER BY due LIMIT 1", (now,)
            )
            if row is None:
                return None
            self._database.execute(
                "UPDATE archive SET due = ? WHERE render_id = ?", (now + lease_seconds, row["render_id"])
            )
        return str(row["render_id"])

    def copied(self, render_id: str, files: Mapping[str, Archived]) -> bool:
        """These are in the object store now. Images that became final again meanwhile stay due. False if the
        render was deleted meanwhile."""
        content = json.dumps({name: asdict(file) for name, file in files.items()}, sort_keys=True)
        changed = self._database.execute(
            "UPDATE archive SET files = ?, due = iif(due = 0, 0, NULL) WHERE render_id = ?",
            (content, render_id),
        )
        return changed == 1

    def file(self, render_id: str, name: str) -> Archived | None:
        """The object store's entry for a render's file; None where there is none."""
        row = self._database.row("SELECT files FROM archive WHERE render_id = ?", (render_id,))
        files = {} if row is None else json.loads(row["files"])
        return Archived(**files[name]) if name in files else None

    def renders(self) -> Sequence[str]:
        """All whose images are in the object store."""
        rows = self._database.rows("SELECT render_id FROM archive WHERE due IS NULL ORDER BY render_id")
        return [str(row["render_id"]) for row in rows]
