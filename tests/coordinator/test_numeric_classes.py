"""Which workers may work on which renders. The rules alone; with a service: tests/faults."""

from dataclasses import replace
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.failure_policy import Faults
from nocturne_coordinator.dispatch.profiles import (
    REDONE_SECONDS,
    class_of,
    refusal_of,
    should_start_anew,
    shut_out,
    threads_by_class,
    usual_class,
)
from nocturne_coordinator.dispatch.result_handler import Intake
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Schedule
from nocturne_coordinator.store.data_folder import DataFolder, NewRender, WorkerRow
from nocturne_coordinator.store.ledger import Ledger, OpenRender, Totals
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.rows import UNKNOWN_CLASS, RenderState
from nocturne_scene.ranges import make_plan

from tests.coordinator.simulated_worker import simulated_result

A, B = "a" * 16, "b" * 16
ENGINE = int(job_pb2.ENGINE_CURRENT)


def worker(name: str, numeric_class: str, threads: int = 1, engine: int = ENGINE) -> WorkerRow:
    return WorkerRow(name, engine, threads, 0, 0, 0.0, 0, 0.0, 0.0, numeric_class)


@pytest.mark.parametrize("told", ["", "a1", "A" * 16, "a" * 17, "../../etc/passwd"])
def test_what_is_no_digest_is_one_class(told: str) -> None:
    assert class_of(told) == UNKNOWN_CLASS
    assert class_of(A) == A


def test_threads_count_not_workers() -> None:
    workers = [worker("1", A), worker("2", A), worker("3", B, 3), worker("4", A, 9, ENGINE - 1)]
    assert threads_by_class(workers, ()) == {A: 2, B: 3}
    assert usual_class(threads_by_class(workers, ())) == B
    assert usual_class(threads_by_class(workers, {"3"})) == A
    assert usual_class({B: 2, A: 2}) == A
    assert usual_class({}) == ""


def test_a_result_must_have_its_renders_class() -> None:
    assert refusal_of(A, A, {B: 9}) == ""
    assert refusal_of(A, B, {B: 9}) == f"numeric class {B}, the render has {A}"


def test_the_first_result_may_not_be_of_a_rare_class() -> None:
    assert refusal_of("", B, {A: 2, B: 1}) == f"numeric class {B}, most workers have {A}"
    for alike in ({A: 2, B: 2}, {B: 1}, {}):
        assert refusal_of("", B, alike) == ""


def test_only_a_short_start_is_made_anew() -> None:
    assert should_start_anew(B, {A: 2, B: 1}, 2 * REDONE_SECONDS)
    assert not should_start_anew(B, {A: 2, B: 1}, 2 * REDONE_SECONDS + 1.0)
    assert not should_start_anew(B, {A: 2, B: 2}, 0.0)
    assert not should_start_anew("", {A: 2}, 0.0)
    assert not should_start_anew(B, {}, 0.0)


def test_workers_are_told_why_they_get_no_jobs() -> None:
    workers = [worker("a", A, 2), worker("b", B), worker("old", A, 1, ENGINE - 1)]
    old = f"It has engine {ENGINE - 1}, and the service engine {ENGINE}."
    assert shut_out(workers, (), ()) == {"old": old}
    assert shut_out(workers, (), {""}).keys() == {"b", "old"}
    assert shut_out(workers, (), {A, B}).keys() == {"old"}
    assert shut_out(workers, (), {B, ""}).keys() == {"old"}
    assert shut_out(workers, {"a"}, {""}) == {
        "a": f"It rounds otherwise: numeric class {A}; the open renders have {B}.",
        "old": old,
    }


def test_an_odd_result_touches_nothing() -> None:
    plan = make_plan(32, 32, 8)
    row = OpenRender("r", RenderState.RUNNING, plan, "5c" * 32, ENGINE, Totals(), numeric_class=A)
    render = RunningRender(row, [])
    schedule, auditor = Schedule(), Auditor(1.0, 1.0)
    schedule.add("r", len(plan.range_ends), [0])
    intake = Intake({"r": render}, schedule, auditor, Faults(), live=lambda _: {"w", "odd"})
    (key, *_) = schedule.take(1)
    schedule.published(key, b"1-1", 0.0)
    job = render.planned.job(0, render.planned.ranges[0])
    result = simulated_result(job, "odd")
    result.numeric_class = B
    outcome = intake.take(b"2-1", result.SerializeToString(), 0.0)
    assert (outcome.settled, outcome.withdrawn) == ([b"2-1"], [b"1-1"])
    assert render.merged_ranges == [0]
    # Also not as an audit, which would find a liar where there is none.
    schedule.published(key, b"1-2", 0.0)
    result.numeric_class, result.worker_id = A, "w"
    intake.take(b"2-2", result.SerializeToString(), 0.0)
    assert render.merged_ranges == [1]
    assert auditor.is_open(JobKey("r", 0, 0))
    odd = simulated_result(job, "odd")
    odd.numeric_class, odd.partial.rays = B, odd.partial.rays + 1
    assert intake.take(b"2-3", odd.SerializeToString(), 0.0).quarantined == {}
    assert auditor.mismatches == 0


def test_renders_that_nobody_can_work_on_leave_the_window_to_others() -> None:
    schedule = Schedule()
    schedule.add("waits", 4, [0] * 4)
    schedule.add("goes on", 4, [0] * 4)
    assert {key.render_id for key in schedule.take(8, {"waits"})} == {"goes on"}


def test_a_render_started_anew_has_nothing_but_its_cost(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path)
    plan = make_plan(32, 32, 8)
    new = NewRender("q", "", "5c" * 32, "{}", 32, 32, 8, plan, numeric_class=B)
    render_id = folder.create_render(new).id
    ownership = Ownership(tmp_path, folder.database)
    try:
        ledger = Ledger(folder.database, ownership)
        taken = ledger.take(render_id)
        assert taken is not None
        assert ledger.start(render_id, taken.fence, 1.0)
        ledger.start_anew(render_id, taken.fence)
        assert folder.get_render(render_id).numeric_class == ""
        # Who had it in memory has lost it.
        assert ledger.lost({render_id: taken.fence}) == [render_id]
        again = ledger.take(render_id)
        assert again is not None
        assert replace(again, fence=0) == replace(taken, fence=0, numeric_class="", state=RenderState.RUNNING)
    finally:
        ownership.release()
        folder.close()
