"""Audits: who may settle one, who contradicts itself, and who is not audited: rows L5, L6, P15."""

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.failure_policy import FailurePolicy
from nocturne_coordinator.dispatch.fleet import Fleet
from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
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
    """L5: asked second or third, it now sends the right result: its first one is in the image."""
    auditor = audited("a", WRONG, "a", "b", "c")
    found = [auditor.again(KEY, worker, RIGHT, {"a", "b", "c"}) for worker in seconds]
    assert [worker for finding in found for worker in finding.mismatching] == ["a"]
    assert auditor.agreed == 0
    assert auditor.mismatches == 1


def test_a_job_that_was_done_again_while_nobody_else_was_there_is_audited_once() -> None:
    """L6: of a job that was asked for twice one would be left when the render is let go."""
    auditor = audited("a", RIGHT, "a")
    auditor.again(KEY, "a", RIGHT, {"a"})
    assert auditor.take(9) == []
    auditor.look(lambda _: {"a", "b"})
    assert auditor.forget(KEY.render_id) == []
    assert auditor.take(9) == []


def test_a_worker_does_not_confirm_itself() -> None:
    """L6: nor does asking it again and again."""
    auditor = audited("a", RIGHT, "a", "b")
    for _ in range(20):
        auditor.published(KEY, b"1-0", 0.0)
        assert not auditor.again(KEY, "a", RIGHT, {"a", "b", "c"}).agreed
    assert not auditor.is_open(KEY)
    assert (auditor.agreed, auditor.unsettled["r"]) == (0, 1)


def test_an_auditor_that_contradicts_itself_leaves_the_audit_open() -> None:
    """L5: another one has to decide."""
    auditor = audited("a", RIGHT, "a", "b", "c")
    auditor.again(KEY, "b", WRONG, {"a", "b", "c"})
    assert list(auditor.again(KEY, "b", RIGHT, {"a", "b", "c"}).mismatching) == ["b"]
    assert auditor.again(KEY, "c", RIGHT, {"a", "b", "c"}).agreed


def test_a_range_that_came_before_the_second_machine_is_audited_later() -> None:
    """L6."""
    auditor = audited("a", WRONG, "a")
    assert auditor.take(9) == []
    auditor.look(lambda _: {"a"})
    assert auditor.take(9) == []
    auditor.look(lambda _: {"a", "b"})
    assert auditor.take(9) == [KEY]


def test_machines_of_one_token_confirm_each_other_where_no_others_are() -> None:
    """P15."""
    live = {"pool:1", "pool:2"}
    auditor = audited("pool:1", RIGHT, *live)
    assert auditor.again(KEY, "pool:2", RIGHT, live).agreed


def test_machines_of_one_token_do_not_confirm_each_other_beside_others() -> None:
    """P15: who holds a token may give them any names."""
    live = {"pool:1", "pool:2", "other"}
    auditor = audited("pool:1", WRONG, *live)
    assert not auditor.again(KEY, "pool:2", WRONG, live).agreed
    assert auditor.mismatches == 0
    found = auditor.again(KEY, "other", RIGHT, live)
    assert (found.agreed, found.mismatching, auditor.mismatches) == (False, {}, 1)
    assert auditor.again(KEY, "third", RIGHT, live).mismatching.keys() == live - {"other"}


def test_a_faulty_machine_is_found_by_those_of_its_token() -> None:
    """P15: also next to others, which are then asked, too."""
    live = {"pool:1", "pool:2", "pool:3", "other"}
    auditor = audited("pool:1", RIGHT, *live)
    auditor.again(KEY, "pool:2", WRONG, live)
    found = auditor.again(KEY, "pool:3", RIGHT, live)
    assert (found.agreed, list(found.mismatching)) == (False, ["pool:2"])
    assert auditor.again(KEY, "other", RIGHT, live).agreed


def test_a_faulty_node_of_a_pool_is_out_and_the_others_work_on() -> None:
    """P15: of four pods of one token on three nodes."""
    world = World(settings=ALL)
    world.start()
    world.worker(wrong_once(5), machine="pool:n1")
    for node in ("n1", "n2", "n3"):
        world.worker(machine=f"pool:{node}")
    render = world.create(1000, width=160)
    world.check_survived(render)
    assert world.store.bad_workers == ["pool:n1"]
    # Of two nodes that are left, one in 64 ranges comes back to the one that did it six times.
    assert world.row(render).totals.audited > 0.8 * world.done(render)


def test_the_third_faulty_machine_of_a_token_puts_all_of_it_out() -> None:
    """P15."""
    policy = FailurePolicy()
    assert [policy.mismatched(f"pool:{node}", 0.0) for node in (1, 1, 2, 3)] == [False, False, False, True]
    assert [policy.mismatched(f"old:{day}", 86400.0 * day) for day in (1, 2, 3)] == [False] * 3
    assert not any(policy.mismatched(f"alone-{number}", 0.0) for number in range(5))
    fleet = Fleet()
    fleet.quarantined = {"pool": "Three of its machines were found faulty."}
    names = ("pool:1/a", "pool:9/b", "other/c")
    fleet.seen(tuple(WorkerRow(name, job_pb2.ENGINE_CURRENT, 1, 0, 0, 0.0, 0, 1.0, 1.0) for name in names))
    assert fleet.live() == {"other"}
    assert fleet.without_jobs().keys() == {"pool", "pool:1", "pool:9"}


def test_a_job_fails_by_three_nodes_and_not_by_one() -> None:
    """P15: of one token; next to others, not by it alone."""
    policy, live = FailurePolicy(), {"pool:1", "pool:2", "pool:3", "pool:4"}
    assert [policy.failed(KEY, "pool:1", "no", live, 0.0) for _ in range(9)] == [None] * 9
    assert policy.failed(KEY, "pool:2", "no", live, 0.0) is None
    assert policy.failed(KEY, "pool:3", "no", live, 0.0) is not None
    live.add("other")
    assert [policy.failed(KEY, f"pool:{number}", "no", live, 0.0) for number in range(9)] == [None] * 9
    assert policy.failed(KEY, "other", "no", live, 0.0) is not None


def wrong_once(number: int) -> Alter:
    """One result is wrong, by one unit in the last place: a transient fault, or a hostile worker that knows
    its range again."""
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


def test_a_small_render_does_not_wait_for_machines_that_are_at_long_jobs() -> None:
    """L6: no longer than ten seconds, or than it ran, and counts the unaudited ranges."""
    world = World(settings=ALL)
    world.start()
    # Without jobs until it has taken one that it never ends.
    others = world.worker(delay=1000.0)
    long = world.create(1)
    world.run_until(lambda: others.has_job)
    world.store.change(long, owner="another")
    author = world.worker()
    # So that both are known.
    world.run(5.0)
    render = world.create(16)
    begun = world.clock.now
    world.run_until(lambda: world.done(render) == 2 * 3)
    author.delay = 1000.0
    world.run_until(lambda: world.row(render).state is RenderState.SUCCEEDED)
    assert 10.0 < world.clock.now - begun < 15.0
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
