"""Which workers may work on which renders. The rules alone; with a service: tests/faults."""

from dataclasses import replace
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.profiles import (
    REDONE_SECONDS,
    incompatible,
    machines_by_profile,
    profile_of,
    refusal_of,
    should_start_anew,
    usual_profiles,
    votes_by_profile,
)
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.records import UNKNOWN_PROFILE, OpenRender, RenderState, Totals, WorkerRow
from nocturne_coordinator.dispatch.result_handler import ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_coordinator.dispatch.state import Settings, State
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule

from tests.coordinator.simulated_worker import simulated_result

A, B = "a" * 16, "b" * 16
ENGINE = int(job_pb2.ENGINE_CURRENT)


def worker(name: str, floating_point_profile: str, threads: int = 1, engine: int = ENGINE) -> WorkerRow:
    return WorkerRow(name, engine, threads, 0, 0, 0.0, 0, 0.0, 0.0, floating_point_profile)


@pytest.mark.parametrize("told", ["", "a1", "A" * 16, "a" * 17, "../../etc/passwd"])
def test_what_is_no_digest_is_one_class(told: str) -> None:
    assert profile_of(told) == UNKNOWN_PROFILE
    assert profile_of(A) == A


def test_machines_count_not_workers_or_threads() -> None:
    workers = [worker("1/a", A), worker("2", A), worker("3", B, 3), worker("4", A, 9, ENGINE - 1)]
    workers += [worker("3/b", B, 4096), worker("3/c", B)]
    assert machines_by_profile(workers, {}) == {A: 2, B: 1}
    assert usual_profiles(machines_by_profile(workers, {})) == {A}
    assert usual_profiles(machines_by_profile(workers, {"1": "It lied.", "2": "It lied."})) == {B}
    assert usual_profiles({B: 2, A: 2, UNKNOWN_PROFILE: 1}) == {A, B}
    assert usual_profiles({}) == set()


def test_a_token_votes_once_where_there_are_others() -> None:
    pods = [worker("pool:n1/a", A), worker("pool:n2/a", A), worker("pool:n3/a", B)]
    assert votes_by_profile(pods, {}) == {A: 2, B: 1}
    many = [*pods, worker("liar:x/a", B), worker("liar:y/a", B), worker("liar:z/a", B)]
    assert votes_by_profile(many, {}) == {A: 1, B: 2}
    assert machines_by_profile(many, {"liar": "It lied."}) == {A: 2, B: 1}


def test_a_result_must_have_its_renders_class() -> None:
    assert refusal_of(A, A, {B: 9}) == ""
    assert refusal_of(A, B, {B: 9}) == f"floating-point profile {B}, the render has {A}"


def test_the_first_result_may_not_be_of_a_rare_class() -> None:
    assert refusal_of("", B, {A: 2, B: 1}) == f"floating-point profile {B}, most machines have {A}"
    for alike in ({A: 2, B: 2}, {B: 1}, {}):
        assert refusal_of("", B, alike) == ""


def test_only_a_short_start_is_made_anew() -> None:
    assert should_start_anew(B, {A: 2, B: 1}, 2 * REDONE_SECONDS)
    assert not should_start_anew(B, {A: 2, B: 1}, 2 * REDONE_SECONDS + 1.0)
    assert not should_start_anew(B, {A: 2, B: 2}, 0.0)
    assert not should_start_anew("", {A: 2}, 0.0)
    # What one machine says of itself discards nothing.
    assert not should_start_anew(B, {A: 1}, 0.0)
    assert not should_start_anew(B, {}, 0.0)


def test_workers_are_told_why_they_get_no_jobs() -> None:
    workers = [worker("a", A), worker("c", A), worker("b", B), worker("old", A, 1, ENGINE - 1)]
    old = f"It has engine {ENGINE - 1}, and the service engine {ENGINE}."
    assert incompatible(workers, {}, ()) == {"old": old}
    assert incompatible(workers, {}, {""}).keys() == {"b", "old"}
    assert incompatible(workers, {}, {A, B}).keys() == {"old"}
    assert incompatible(workers, {}, {B, ""}).keys() == {"old"}
    other = f"It rounds otherwise: floating-point profile {A}; the open renders have {B}."
    assert incompatible(workers, {"a": "It lied.", "c": "It lied."}, {""}) == {
        "a": other,
        "c": other,
        "old": old,
    }


def test_an_odd_result_touches_nothing() -> None:
    schedule = make_schedule(32, 32, 8)
    row = OpenRender(
        "r", RenderState.RUNNING, schedule, "5c" * 32, ENGINE, Totals(), floating_point_profile=A
    )
    render = RunningRender(row, [])
    scheduler, auditor = Scheduler(), Auditor(1.0, 1.0)
    scheduler.add("r", render.range_queues())
    state = State(Settings(), scheduler, auditor, {"r": render})
    state.fleet.seen((worker("w", A), worker("odd", A)))
    handler = ResultHandler(state)
    (key, *_) = scheduler.take(1)
    scheduler.published(key, b"1-1", 0.0)
    job = render.planned.job(0, render.planned.ranges[0])
    result = simulated_result(job, "odd")
    result.floating_point_profile = B
    outcome = handler.take(b"2-1", result.SerializeToString(), 0.0, 0.5)
    assert (outcome.to_acknowledge, outcome.withdrawn) == ([b"2-1"], [b"1-1"])
    assert render.film.queues[0].merged == 0
    # Nor as an audit, which would blame a correct worker.
    scheduler.published(key, b"1-2", 0.0)
    result.floating_point_profile, result.worker_id = A, "w"
    handler.take(b"2-2", result.SerializeToString(), 0.0, 0.5)
    assert render.film.queues[0].merged == 1
    assert auditor.is_open(JobKey("r", 0, 0))
    odd = simulated_result(job, "odd")
    odd.floating_point_profile, odd.partial.rays = B, odd.partial.rays + 1
    assert handler.take(b"2-3", odd.SerializeToString(), 0.0, 0.5).quarantined == []
    assert auditor.mismatches == 0


def test_renders_that_nobody_can_work_on_leave_the_window_to_others() -> None:
    scheduler = Scheduler()
    scheduler.add("waits", [RangeQueue(bytearray(4)) for _ in range(4)])
    scheduler.add("goes on", [RangeQueue(bytearray(4)) for _ in range(4)])
    assert {key.render_id for key in scheduler.take(8, {"waits"})} == {"goes on"}


def test_a_render_started_anew_has_nothing_but_its_cost(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path)
    schedule = make_schedule(32, 32, 8)
    new = NewRender("q", "", "5c" * 32, "{}", 32, 32, 8, schedule, floating_point_profile=B)
    render_id = folder.renders.create(new).id
    ownership = Ownership(tmp_path, folder.database)
    try:
        ledger = Ledger(folder.database, ownership)
        taken = ledger.renders.take(render_id)
        assert taken is not None
        assert ledger.commits.start(render_id, taken.fence, 1.0)
        ledger.commits.start_anew(render_id, taken.fence)
        assert folder.renders.get(render_id).floating_point_profile == ""
        # Who had it in memory has lost it.
        assert ledger.leases.lost({render_id: taken.fence}) == [render_id]
        again = ledger.renders.take(render_id)
        assert again is not None
        assert replace(again, fence=0) == replace(
            taken, fence=0, floating_point_profile="", state=RenderState.RUNNING
        )
    finally:
        ownership.release()
        folder.close()
