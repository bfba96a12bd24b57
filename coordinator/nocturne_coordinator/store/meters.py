"""What coordinators count and measure, for others to show."""

from collections.abc import Callable, Iterable, Mapping

from nocturne_coordinator.store.database import Database

# Of several coordinators: what one of them alone may say. All else is added up.
_TOGETHER: Mapping[str, Callable[[Iterable[float]], float]] = {
    "coordinator_seen": max,
    "folder_trouble": max,
    "worker_threads": max,
    "machines": max,
    "job_seconds": max,
    "result_seconds": max,
    "redis_in_step": min,
}


class Meters:
    """The meters of a data folder; each coordinator has its own."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def read(self) -> dict[str, float]:
        """What the coordinators last counted and measured, by name: of several, the sum, or what fits."""
        values: dict[str, list[float]] = {}
        for row in self._database.rows("SELECT name, value FROM meter"):
            values.setdefault(row["name"], []).append(row["value"])
        return {name: float(_TOGETHER.get(name, sum)(found)) for name, found in values.items()}

    def write(self, coordinator: int, values: Mapping[str, float]) -> None:
        """A coordinator's own; to be called by it, in a transaction."""
        self._database.execute_many(
            """INSERT INTO meter VALUES (?, ?, ?)
               ON CONFLICT (coordinator, name) DO UPDATE SET value = excluded.value""",
            [(coordinator, name, value) for name, value in values.items()],
        )
