"""A small render waits for nobody's long jobs, which go on: a thread more does its jobs (decision 0139)."""

import random
import time
from pathlib import Path

import httpx
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.store.data_folder import DataFolder

from tests.coordinator.memory_queue import Worker
from tests.coordinator.world import World
from tests.faults.survival import note
from tests.faults.tricks import ENDLESS, seconds_of_a_small_render
from tests.system.up import Up
from tests.system.waiting import wait_for

_LONG_S = 40.0
_MOST_S = 3.0


class Farm(World):
    """Workers of a thread each, and of one more for quick jobs; a job of a render of the long owner takes
    forty seconds."""

    def __init__(self, threads: int, seed: int = 1, audits: float = 0.0) -> None:
        super().__init__(seed, Settings(commit_seconds=0.1, audit_share=audits, audit_share_new=audits))
        self.long: set[str] = set()
        self.start()
        for _ in range(threads):
            worker = self.worker(quick=True)
            for each in (worker, worker.quick):
                assert each is not None
                each.seconds = self._seconds

    def _seconds(self, job: job_pb2.Job) -> float:
        return _LONG_S if job.render_id in self.long else 0.02

    def render(self, owner: str, samples: int = 1, width: int = 34) -> str:
        render = self.create(samples, width=width)
        self.store.change(render, owner=owner)
        if owner.startswith("long"):
            self.long.add(render)
        return render

    def seconds_of(self, owner: str) -> float:
        begun, render = self.clock.now, self.render(owner)
        self.run_until(lambda: self.row(render).state is RenderState.SUCCEEDED, 400.0)
        self.check_sums(render)
        return self.clock.now - begun


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_a_small_render_waits_for_nobodys_long_jobs(threads: int) -> None:
    """P17: whenever it comes, and who has long jobs loses nothing of them."""
    farm, chance = Farm(threads), random.Random(threads)
    long = farm.render("long", 16, 34 * threads)
    farm.run(5.0)
    while not farm.row(long).state.ended:
        assert farm.seconds_of("short") < _MOST_S
        farm.run(chance.uniform(0.0, 20.0))
        # Two or three ranges of each tile, one after the other.
        assert farm.clock.now < 1000.0 + 8 * _LONG_S + 30.0
    farm.check_sums(long)


def test_many_tiles_are_done_one_after_the_other() -> None:
    """P17: a render of ten tiles, behind long jobs."""
    farm = Farm(2)
    farm.render("long", 10**5, 68)
    farm.run(5.0)
    begun, render = farm.clock.now, farm.render("short", 1, 320)
    farm.run_until(lambda: farm.row(render).state is RenderState.SUCCEEDED, 30.0)
    assert farm.clock.now - begun < _MOST_S


def test_another_machine_audits_a_small_render_meanwhile() -> None:
    """P17: all its ranges, at once."""
    farm = Farm(3, audits=1.0)
    farm.render("long", 10**5, 102)
    farm.run(5.0)
    begun, render = farm.clock.now, farm.render("short")
    farm.run_until(lambda: farm.row(render).state is RenderState.SUCCEEDED, 30.0)
    assert farm.clock.now - begun < _MOST_S
    assert farm.row(render).totals.audited == 2


def test_long_jobs_hold_up_quick_ones_for_half_a_second() -> None:
    """P17: of four owners with long jobs two have none of the threads; their copies are stopped, nothing of
    them is cut and none of their jobs fails."""
    farm = Farm(2)
    longs = [farm.render(f"long {number}", 8) for number in range(4)]
    farm.run(5.0)
    for _ in range(3):
        assert farm.seconds_of("short") < _MOST_S
    farm.run_until(lambda: all(farm.row(each).state.ended for each in longs), 800.0)
    for each in longs:
        assert farm.row(each).state is RenderState.SUCCEEDED
        farm.check_sums(each)


def test_where_a_thread_is_free_or_nobody_else_there_nothing_is_copied() -> None:
    """P17: a copy is work that may be done twice."""
    alone, idle = Farm(1), Farm(8)
    alone.render("long", 16)
    alone.render("long", 4)
    idle.render("long", 4)
    idle.run(5.0)
    assert idle.seconds_of("short") < _MOST_S
    alone.run(100.0)
    for farm in (alone, idle):
        assert not [entry for entry in farm.queue.delivered if entry.startswith(b"0-")]
        assert not any(worker.jobs_done for worker in _quick_threads(farm))


def test_copies_of_an_earlier_run_are_no_jobs() -> None:
    """P17: the coordinator is killed while one is out."""
    farm = Farm(2)
    farm.render("long", 16, 68)
    farm.run(5.0)
    for worker in _quick_threads(farm):
        worker.stand_still(20.0)
    render = farm.render("short")
    farm.run_until(lambda: any(entry.startswith(b"0-") for entry in farm.queue.job_stream))
    farm.kill()
    farm.start()
    farm.run_until(lambda: farm.row(render).state is RenderState.SUCCEEDED, 60.0)
    farm.check_sums(render)


@pytest.mark.system
def test_behind_a_scene_without_end(tmp_path: Path) -> None:
    """P17: a real worker of two threads, both busy for minutes."""
    with Up(tmp_path, 1, 2, "--auth") as service:
        folder = DataFolder(service.data)
        long, short = (
            httpx.Client(
                base_url=service.url,
                headers={"Authorization": f"Bearer {folder.tokens.create(name, ['submit'])}"},
                timeout=60,
            )
            for name in ("long", "short")
        )
        folder.close()
        with long, short:
            # With few samples, for which no pilot is asked.
            body = {"request_id": "e", "scene": ENDLESS, "width": 64, "height": 64, "samples": 60}
            address = f"/v1/renders/{long.post('/v1/renders', json=body).json()['id']}"
            wait_for(lambda: long.get(address).json()["state"] == "RUNNING", "it to run")
            # A look at the workers finds both threads at work.
            time.sleep(3.0)
            waits = [seconds_of_a_small_render(short, number) for number in range(5)]
            assert long.get(address).json()["progress"]["ranges_done"] == 0
            long.post(f"{address}:cancel")
        note("P17", most_s=max(waits))
        assert max(waits) < _MOST_S


def _quick_threads(farm: Farm) -> list[Worker]:
    return [worker for worker in farm.workers if worker.is_quick]
