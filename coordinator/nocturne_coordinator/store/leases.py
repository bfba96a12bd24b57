"""Leases: which coordinator may write what. Every write of a coordinator is inside one of two contexts.

`owned` checks that no later coordinator took the data folder over (its epoch); `holding` also that no other
one took the render, and that nothing changed it from outside (its fence).
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.ownership import Ownership


class Leases:
    """What a coordinator holds in a data folder."""

    def __init__(self, database: Database, ownership: Ownership) -> None:
        self._database = database
        self._ownership = ownership

    @property
    def number(self) -> int:
        """Of this coordinator."""
        return self._ownership.number

    @property
    def lease_seconds(self) -> float:
        """How long nobody takes our renders away without a sign of life."""
        return self._ownership.lease_seconds

    @contextmanager
    def owned(self, durable: bool = False) -> Iterator[None]:
        """A transaction in which the data folder is ours; OwnershipLost if it is not.

        `durable`: the written state is reported to somebody.
        """
        with self._database.transaction(durable):
            self._ownership.check()
            yield

    def renew(self, now: float) -> int:
        """A sign of life, `now` in unix seconds; gives the number of coordinators at work."""
        with self.owned():
            self._database.execute(
                """INSERT INTO coordinator VALUES (?, ?)
                   ON CONFLICT (number) DO UPDATE SET until = excluded.until""",
                (self.number, now + self.lease_seconds),
            )
            self._database.execute("DELETE FROM coordinator WHERE until < ?", (now,))
            self._database.execute(
                "DELETE FROM meter WHERE coordinator NOT IN (SELECT number FROM coordinator)"
            )
            row = self._database.row("SELECT count(*) AS count FROM coordinator")
        return int(row["count"]) if row is not None else 0

    def stay(self, until: float) -> None:
        """Keeps our leases beyond their usual length, in unix seconds, for work during which they can't be
        renewed: else another coordinator would take the render, and lose it likewise."""
        with self.owned():
            self._database.execute(
                "UPDATE coordinator SET until = max(until, ?) WHERE number = ?",
                (until + self.lease_seconds, self.number),
            )

    def resign(self) -> None:
        """Nobody needs to wait for our leases to end."""
        with self.owned():
            self._database.execute("DELETE FROM coordinator WHERE number = ?", (self.number,))

    def take(self, render_id: str) -> None:
        """The render is ours from here on, with a new fence; to be called inside `owned`."""
        self._database.execute(
            """INSERT INTO lease VALUES (?, ?, 1)
               ON CONFLICT (render_id)
               DO UPDATE SET coordinator = excluded.coordinator, fence = lease.fence + 1""",
            (render_id, self.number),
        )

    def let_go(self, render_id: str, fence: int) -> None:
        """Whoever wants may take the render."""
        with self.owned():
            self._database.execute(
                "UPDATE lease SET coordinator = 0 WHERE render_id = ? AND coordinator = ? AND fence = ?",
                (render_id, self.number, fence),
            )

    @contextmanager
    def holding(self, render_id: str, fence: int, durable: bool = False) -> Iterator[None]:
        """A transaction in which the render is ours and stays so; LeaseLost if it is not."""
        with self.owned(durable):
            if not self.holds(render_id, fence):
                raise LeaseLost(render_id)
            yield

    def lost(self, fences: Mapping[str, int]) -> list[str]:
        """Of renders and the fences that they had, those that are another coordinator's now."""
        return [render_id for render_id, fence in fences.items() if not self.holds(render_id, fence)]

    def holds(self, render_id: str, fence: int) -> bool:
        """Whether the render is ours still; to be called in a transaction where something hangs on it."""
        row = self._database.row(
            "SELECT 1 FROM lease WHERE render_id = ? AND coordinator = ? AND fence = ?",
            (render_id, self.number, fence),
        )
        return row is not None
