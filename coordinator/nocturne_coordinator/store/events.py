"""What happened to workers: who joined, left, was put in quarantine or let out again."""

from nocturne_coordinator.store.database import Database

_KEPT = 1000


def note_worker(database: Database, now: float, worker_id: str, what: str, reason: str) -> None:
    """One more line; the last 1000 are kept. To be called inside a transaction."""
    database.execute(
        "INSERT INTO worker_event (unix_time, worker_id, what, reason) VALUES (?, ?, ?, ?)",
        (now, worker_id, what, reason),
    )
    database.execute(
        "DELETE FROM worker_event WHERE number <= (SELECT max(number) FROM worker_event) - ?", (_KEPT,)
    )
