"""Which render needs which blobs: its compiled scene, files that this and the document name, its layers. And
deleted renders whose files may still be there."""

import json
from collections.abc import Iterable, Sequence

from nocturne_coordinator.store.database import Database


class BlobUse:
    """The use of a data folder's blobs."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def note(self, render_id: str, blobs: Iterable[str]) -> None:
        """To be called in the transaction that makes the render, or gives it the blobs."""
        self._database.execute_many(
            "INSERT INTO blob_use VALUES (?, ?) ON CONFLICT DO NOTHING",
            [(render_id, sha256) for sha256 in blobs],
        )

    def of(self, render_id: str) -> tuple[str, ...]:
        """Digests of the blobs that a render needs; an empty one: and others that are not known."""
        query = "SELECT sha256 FROM blob_use WHERE render_id = ? ORDER BY sha256"
        return tuple(row["sha256"] for row in self._database.rows(query, (render_id,)))

    def unused(self, blobs: Iterable[str]) -> list[str]:
        """Those that no render needs; none while there is a render that needs unknown ones."""
        query = "SELECT 1 FROM blob_use WHERE sha256 = ? LIMIT 1"
        if self._database.row(query, ("",)) is not None:
            return []
        return sorted(sha256 for sha256 in set(blobs) if self._database.row(query, (sha256,)) is None)


class Removals:
    """Files still to be removed from a data folder. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def note(self, render_id: str, files: Sequence[str]) -> None:
        """To be called in the transaction that deletes the render's rows."""
        self._database.execute("INSERT INTO removal VALUES (?, ?)", (render_id, json.dumps(files)))

    def open(self) -> list[tuple[str, list[str]]]:
        """Renders, and the digests of the files that each used."""
        rows = self._database.rows("SELECT render_id, files FROM removal ORDER BY render_id")
        return [(row["render_id"], json.loads(row["files"])) for row in rows]

    def done(self, render_id: str) -> None:
        """All of it is gone."""
        self._database.execute("DELETE FROM removal WHERE render_id = ?", (render_id,))
