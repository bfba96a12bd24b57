"""What a coordinator's look at the data folder costs: steps of SQLite and calls of functions, not seconds."""

import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from nocturne_coordinator import limits
from nocturne_coordinator.coordinator import Coordinator
from nocturne_coordinator.dispatch.events import RendersSeen
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.groups import Groups
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.rows import NewRender
from nocturne_coordinator.store.sqlite import SqliteDatabase
from nocturne_scene.ranges import make_schedule

from tests.coordinator.world import World


class Looking:
    """A data folder, and a coordinator's reads of it."""

    def __init__(self, folder: DataFolder) -> None:
        self.folder = folder
        self.renders = Ledger(folder.database, Ownership(folder.root, folder.database)).renders
        schedule = make_schedule(8, 8, 4)
        model = folder.renders.create(NewRender("model", "", "5c" * 32, "{}", 8, 8, 4, schedule)).id
        row = folder.database.row("SELECT * FROM render WHERE id = ?", (model,))
        assert row is not None
        self._model = {**dict(row), "number": None}
        folder.database.execute("DELETE FROM render")
        self._made = 0

    def queue(
        self, count: int, state: str = "QUEUED", after_group: str = "", in_group: str = ""
    ) -> list[str]:
        """So many renders of one owner, all alike; gives their ids."""
        ended = state not in ("QUEUED", "RUNNING", "PAUSED")
        like = {"owner": "ann", "state": state, "image_final": int(ended)}
        like |= {"after_group": after_group, "in_group": in_group}
        made = [f"r-{self._made + number}" for number in range(count)]
        self._made += count
        rows = [{**self._model, **like, "id": each, "request_id": each} for each in made]
        names = ", ".join(self._model)
        places = ", ".join("?" * len(self._model))
        with self.folder.database.transaction(durable=False):
            self.folder.database.execute_many(
                f"INSERT INTO render ({names}) VALUES ({places})",  # noqa: S608
                [tuple(row.values()) for row in rows],
            )
        return made

    def look(self) -> list[str]:
        """Ids of the rows that are read."""
        return [render.id for render in [*self.renders.all(), *self.renders.ended_without_image()]]

    def steps(self, call: Callable[[], object]) -> int:
        """Tens of instructions of SQLite's that the call takes."""
        counted = 0

        def count() -> int:
            nonlocal counted
            counted += 1
            return 0

        database = self.folder.database
        assert isinstance(database, SqliteDatabase)
        connection = database._connection
        connection.set_progress_handler(count, 10)
        try:
            call()
        finally:
            connection.set_progress_handler(None, 0)
        return counted


@pytest.fixture
def looking(tmp_path: Path) -> Iterator[Looking]:
    with closing(DataFolder(tmp_path / "data")) as folder:
        yield Looking(folder)


def test_does_not_read_what_has_ended(looking: Looking) -> None:
    """A folder keeps thousands of them."""
    running, queued = looking.queue(1, "RUNNING"), looking.queue(1)
    without_image = looking.queue(1, "PAUSED")
    before = looking.steps(looking.look)
    looking.queue(300, "SUCCEEDED", in_group="film")
    assert looking.look() == [*running, *queued, *without_image]
    assert looking.steps(looking.look) <= before + 10


def test_a_group_is_looked_for_once(looking: Looking) -> None:
    """P7: with 4,000 renders after a group that had ended, a look took 35 s, and all others waited."""
    looking.queue(50, "SUCCEEDED", in_group="first")
    second = looking.queue(50, after_group="first", in_group="second")
    assert set(looking.look()) <= set(second)
    few = looking.steps(looking.look)
    looking.queue(150, "SUCCEEDED", in_group="first")
    looking.queue(150, after_group="first", in_group="second")
    # Four times as many: the square of that is 16.
    assert looking.steps(looking.look) < 6 * few


def test_what_waits_goes_on_when_the_last_of_the_group_has_ended(looking: Looking) -> None:
    first = looking.queue(2, in_group="first")
    [second] = looking.queue(1, after_group="first")
    [of_nothing] = looking.queue(1, after_group="none of this name")
    groups = Groups(looking.folder.database)
    for states, waits in ((("SUCCEEDED", "PAUSED"), True), (("SUCCEEDED", "CANCELLED"), False)):
        for render_id, state in zip(first, states, strict=True):
            looking.folder.database.execute("UPDATE render SET state = ? WHERE id = ?", (state, render_id))
        assert groups.waits(second) is waits
        assert (second in {render.id for render in looking.renders.all()}) is not waits
    assert not groups.waits(of_nothing)


def test_tiles_that_failed_come_with_their_render(looking: Looking) -> None:
    [bad, good] = looking.queue(2, "RUNNING")
    looking.folder.database.execute(
        "INSERT INTO failed_tile VALUES (?, 3, 0, 4, 'it crashed', '[\"a\"]')", (bad,)
    )
    found = {render.id: render.failed_tiles for render in looking.renders.all()}
    assert found[good] == ()
    [tile] = found[bad]
    assert (tile.tile_index, tile.reason, tile.workers) == (3, "it crashed", ("a",))


def calls_of_a_look(owners: int) -> int:
    """Of Python functions, when a coordinator that is full looks at ten queued renders of each owner."""
    world = World()
    for number in range(10 * owners):
        world.store.change(world.create(samples=4000), owner=f"owner {number % owners}")
    coordinator = world.start()
    world.run(0.5)
    running = [each for each in world.store.stored.values() if each.row.state is RenderState.RUNNING]
    assert len(running) == limits.MAX_RUNNING + limits.MAX_NEWCOMERS
    rows = tuple(each.row for each in world.store.stored.values())
    seen = RendersSeen(world.clock.moment(), rows, {}, 1)
    counted = 0

    def count(_: FrameType, event: str, __: Any) -> None:
        nonlocal counted
        counted += event == "call"

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        Coordinator.tell(coordinator, seen)
    finally:
        sys.setprofile(before)
    return counted


def test_a_look_takes_as_long_as_there_are_renders_not_times_owners() -> None:
    """P7: with 600 owners and 10,000 renders it took 0.35 s, at every change in the data folder."""
    assert calls_of_a_look(80) < 8 * calls_of_a_look(20)
