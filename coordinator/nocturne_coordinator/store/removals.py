"""Deleted renders whose files may still be there."""

import json
from collections.abc import Sequence

from nocturne_coordinator.store.database import Database


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
