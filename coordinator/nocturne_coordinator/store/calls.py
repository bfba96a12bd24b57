"""Who changed what: one line for each call that changes something."""

import time

from nocturne_coordinator.store.database import Database


class Calls:
    """The record of calls of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def record(self, who: str, what: str, render_id: str, request_id: str, outcome: str, keep: int) -> None:
        """One more line of who changed what; the last `keep` are kept."""
        with self._database.transaction():
            self._database.execute(
                "INSERT INTO call (unix_time, who, what, render_id, request_id, outcome) "
                "VALUES (?, ?, ?, ?, ?, ?)",
                (time.time(), who, what, render_id, request_id, outcome),
            )
            self._database.execute(
                "DELETE FROM call WHERE number <= (SELECT max(number) FROM call) - ?", (keep,)
            )

    def last(self, limit: int) -> list[dict[str, object]]:
        """The last calls that changed something, newest first."""
        rows = self._database.rows("SELECT * FROM call ORDER BY number DESC LIMIT ?", (limit,))
        return [dict(row) for row in rows]
