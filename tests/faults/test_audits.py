"""Audits: who may settle one, workers that contradict themselves, and who is not audited: rows L5, L6."""

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.dispatch.state import Settings

from tests.coordinator.simulated_worker import Alter
from tests.coordinator.world import World

KEY = JobKey("r", 0, 0)
RIGHT = job_pb2.Partial(sums=b"right")
WRONG = job_pb2.Partial(sums=b"wrong")
ALL = Settings(commit_seconds=0.1, audit_share=1.0, audit_share_new=1.0)


def audited(author: str, partial: job_pb2.Partial, *live: str) -> Auditor:
    """A result that was taken, and whose audit is out as often as it is asked for."""
    auditor = Auditor(1.0, 1.0)
    auditor.accepted(KEY, author, partial, lambda: set(live), 0.0)
    return auditor


@pytest.mark.parametrize("seconds", [("a", "b"), ("b", "a")])
def test_a_worker_that_contradicts_itself_is_faulty(seconds: tuple[str, str]) -> None:
    """L5: asked second or third, it now says what is right: its first testimony is what is in the image."""
    auditor = audited("a", WRONG, "a", "b", "c")
    found = [auditor.again(KEY, worker, RIGHT) for worker in seconds]
    assert [worker for finding in found for worker in finding.liars] == ["a"]
    assert auditor.agreed == 0
    assert auditor.mismatches == 1


def test_a_worker_does_not_confirm_itself() -> None:
    """L6: nor does asking it for ever."""
    auditor = audited("a", RIGHT, "a", "b")
    for _ in range(20):
        auditor.published(KEY, b"1-0", 0.0)
        assert not auditor.again(KEY, "a", RIGHT).agreed
    assert not auditor.is_open(KEY)
    assert (auditor.agreed, auditor.unsettled["r"]) == (0, 1)


def test_an_auditor_that_contradicts_itself_leaves_the_audit_open() -> None:
    """L5: another one has to say what is right."""
    auditor = audited("a", RIGHT, "a", "b", "c")
    auditor.again(KEY, "b", WRONG)
    assert list(auditor.again(KEY, "b", RIGHT).liars) == ["b"]
    assert auditor.again(KEY, "c", RIGHT).agreed


def test_a_range_that_came_before_the_second_machine_is_audited_later() -> None:
    """L6."""
    auditor = audited("a", WRONG, "a")
    assert auditor.take(9) == []
    auditor.look(lambda _: {"a"})
    assert auditor.take(9) == []
    auditor.look(lambda _: {"a", "b"})
    assert auditor.take(9) == [KEY]


def wrong_once(number: int) -> Alter:
    """One result is wrong, by one unit in the last place: a transient fault, or a liar that knows its range
    again."""
    sent = 0

    def alter(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        nonlocal sent
        sent += 1
        if sent == number:
            sums = np.frombuffer(result.partial.sums, dtype="<f8")
            result.partial.sums = np.nextafter(sums, np.inf).tobytes()
        return [result]

    return alter


@pytest.mark.parametrize("machines", [2, 3])
@pytest.mark.parametrize("number", [1, 3, 7, 20])
def test_one_wrong_result_is_in_no_image_that_was_audited(machines: int, number: int) -> None:
    """L5: also of two machines: the one that traces its range twice is found, or the render says so."""
    world = World(settings=ALL)
    world.start()
    faulty = world.worker(wrong_once(number), delay=0.01)
    for _ in range(machines - 1):
        world.worker()
    render = world.create(1000, width=160)
    world.run_until(lambda: world.row(render).state.ended, 300.0)
    if world.row(render).state is RenderState.DEGRADED:
        assert machines == 2
        assert "different results" in world.store.stored[render].reason
        return
    world.check_survived(render)
    assert world.store.bad_workers == [faulty.name]


def test_what_came_before_the_coordinator_knew_anybody_is_audited() -> None:
    """L6."""
    world = World(settings=ALL)
    for _ in range(4):
        world.worker()
    render = world.create(16)
    coordinator = world.start()
    coordinator.core.window.workers_seen = lambda _: iter(())  # type: ignore[method-assign, assignment, return-value]
    world.run_until(lambda: world.done(render) == 2 * 3)
    del coordinator.core.window.workers_seen
    world.check_survived(render)
    totals = world.row(render).totals
    assert (totals.audited, totals.unaudited) == (world.done(render), 0)


def test_one_machine_alone_is_not_audited_and_the_render_says_so() -> None:
    """L6: and does not wait for anybody."""
    world = World(settings=ALL)
    world.start()
    world.worker()
    render = world.create(16)
    world.check_survived(render, seconds=9.0)
    totals = world.row(render).totals
    assert (totals.audited, totals.unaudited) == (0, world.done(render))


def test_a_second_machine_audits_what_the_first_did_alone() -> None:
    """L6."""
    world = World(settings=ALL)
    world.start()
    world.worker(delay=0.1)
    render = world.create(400)
    world.run_until(lambda: world.half_done(render))
    assert world.row(render).totals.audited == 0
    world.worker(delay=0.1)
    world.check_survived(render)
    totals = world.row(render).totals
    assert totals.audited + totals.unaudited == world.done(render)
    assert totals.audited > 0.9 * world.done(render)
