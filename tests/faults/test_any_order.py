"""Thousands of orders in which things can happen to the whole service in memory, chosen by hypothesis.

After every event the core's state is validated: open, published, waiting and merged ranges are the planned
ones, none is in two places, counts are those of the ranges, the work in flight is bounded. Committed samples
never go back, and their sums are at any time those of the first ranges in order, bit for bit. In the end,
after all faults are gone, every render succeeds."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.quick_entries import QUICK
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_scene.ranges import extended_schedule

from tests.coordinator.simulated_worker import Alter, Shuffled, unaltered
from tests.coordinator.world import World
from tests.faults.test_lies import Flooder, Forger
from tests.fuzzing import tried

MAX_RENDERS, MAX_WORKERS = 3, 5
EXAMPLES, STEPS = 48, 25


class Night(RuleBasedStateMachine):
    """The possible events."""

    def __init__(self) -> None:
        super().__init__()
        self.world = World(1, Settings(commit_seconds=0.1, overdue_seconds=2.0, audit_share_new=0.3))
        self.world.start()
        self.renders: list[str] = []
        self.forged = False

    @initialize(samples=st.integers(1, 300), window=st.integers(34, 100))
    def begin(self, samples: int, window: int) -> None:
        self.renders.append(self.world.create(samples, width=window))

    @precondition(lambda self: len(self.renders) < MAX_RENDERS)
    @rule(samples=st.integers(1, 300), error=st.sampled_from([0.0, 0.09]))
    def submit(self, samples: int, error: float) -> None:
        # Of several owners: who waits behind long jobs of another has quick copies.
        stop = StopConditions(tile_relative_error=error) if error else EVERYTHING
        self.renders.append(self.world.create(samples, stop, owner=f"owner {len(self.renders)}"))

    @rule(seconds=st.sampled_from([0.0, 0.02, 0.1, 0.5, 3.0, 30.0]))
    def time_passes(self, seconds: float) -> None:
        self.world.run(seconds)

    @precondition(lambda self: len(self.world.workers) < MAX_WORKERS)
    @rule(kind=st.sampled_from(["honest", "slow", "shuffled", "flooder", "forger"]), seed=st.integers(0, 9))
    def worker_comes(self, kind: str, seed: int) -> None:
        self.forged |= kind == "forger"
        alters: dict[str, Alter] = {"shuffled": Shuffled(seed), "flooder": Flooder(seed), "forger": Forger()}
        self.world.worker(alters.get(kind, unaltered), delay=5.0 if kind == "slow" else 0.02)

    @precondition(lambda self: self.world.workers)
    @rule(which=st.integers(0, MAX_WORKERS), how=st.sampled_from(["killed", "told to leave", "stopped"]))
    def worker_goes(self, which: int, how: str) -> None:
        worker = self.world.workers[which % len(self.world.workers)]
        if how == "killed":
            worker.die()
        elif how == "told to leave":
            worker.leave()
        else:
            worker.stand_still(3.0)

    @rule(empty=st.booleans(), seconds=st.sampled_from([0.0, 0.3, 5.0]))
    def redis_restarts(self, empty: bool, seconds: float) -> None:
        self.world.queue.is_down = True
        self.world.run(seconds)
        if empty:
            self.world.queue.flush()
        self.world.queue.is_down = False

    @rule(every=st.integers(2, 20))
    def answers_are_lost_for_a_while(self, every: int) -> None:
        calls = 0

        def lost() -> bool:
            nonlocal calls
            calls += 1
            return calls % every == 0

        self.world.queue.lost_answers = lost
        self.world.run(1.0)
        self.world.queue.lost_answers = lambda: False

    @rule()
    def jobs_are_given_out_again(self) -> None:
        self.world.queue.delivered.clear()

    @rule(keep=st.booleans())
    def quick_copies_of_all_jobs(self, keep: bool) -> None:
        """Beyond any need: they come, are done, or vanish as any job."""
        for coordinator in self.world.coordinators:
            quick, state = coordinator.core.window.quick_copies, coordinator.core.state
            for key, published in [*state.scheduler.out(state.renders), *state.auditor.out(state.renders)]:
                if not published.has_quick and not self.world.queue.is_down:
                    job = job_pb2.Job.FromString(self.world.queue.job_stream.get(published.entries[0], b""))
                    job.quick = True
                    entry = QUICK + self.world.queue.new_entry()
                    if keep and job.render_id:
                        self.world.queue.job_stream[entry] = job.SerializeToString()
                    quick.copied(key, entry, self.world.clock.now)
        for coordinator in self.world.coordinators:
            coordinator.core.validate_state()

    @rule(part=st.integers(1, 3))
    def jobs_vanish(self, part: int) -> None:
        for entry in list(self.world.queue.job_stream)[::part]:
            self.world.queue.complete(entry, [])

    @rule(part=st.integers(1, 3))
    def results_vanish(self, part: int) -> None:
        for entry in list(self.world.queue.result_stream)[::part]:
            del self.world.queue.result_stream[entry]

    @rule()
    def results_come_twice(self) -> None:
        self.world.queue.complete(None, list(self.world.queue.result_stream.values()))

    @rule(seconds=st.sampled_from([0.0, 1.0]))
    def coordinator_is_killed(self, seconds: float) -> None:
        self.world.kill()
        self.world.run(seconds)
        if not self.world.coordinators:
            self.world.start()

    @precondition(lambda self: len(self.world.coordinators) < 2)
    @rule()
    def second_coordinator_comes(self) -> None:
        self.world.start()

    @rule(seconds=st.sampled_from([1.0, 15.0]))
    def coordinator_stands_still(self, seconds: float) -> None:
        coordinator = self.world.coordinators.pop(0)
        self.world.run(seconds)
        self.world.coordinators.append(coordinator)

    @rule(seconds=st.sampled_from([0.1, 2.0]))
    def disk_is_full(self, seconds: float) -> None:
        self.world.store.database.is_full = True
        self.world.run(seconds)
        self.world.store.database.is_full = False

    @rule(which=st.integers(0, MAX_RENDERS), priority=st.integers(1, 1000))
    def render_is_paused_and_resumed(self, which: int, priority: int) -> None:
        render = self.renders[which % len(self.renders)]
        if not self.world.row(render).state.ended:
            self.world.store.change(render, state=RenderState.PAUSED)
            self.world.run(priority % 3 / 10)
            self.world.store.change(render, state=RenderState.QUEUED, priority=priority)

    @rule(which=st.integers(0, MAX_RENDERS), more=st.integers(1, 100))
    def render_is_extended(self, which: int, more: int) -> None:
        render = self.renders[which % len(self.renders)]
        row = self.world.row(render)
        if row.state in (RenderState.RUNNING, RenderState.SUCCEEDED):
            schedule = extended_schedule(row.schedule, row.schedule.range_ends[-1] + more)
            self.world.store.change(render, schedule=schedule, stop=EVERYTHING, state=RenderState.QUEUED)

    @invariant()
    def what_is_committed_is_the_sequential_merge(self) -> None:
        for render in self.renders:
            self.world.check_sums(render)

    def teardown(self) -> None:
        if not self.renders:
            return
        for worker in list(self.world.workers):
            worker.leave()
        self.world.worker()
        world = self.world
        world.run_until(lambda: all(world.row(each).state.ended for each in self.renders), 900.0)
        for render in self.renders:
            # Where nobody but forgers worked, a tile fails, and with all its tiles a render.
            assert world.row(render).state.has_image or self.forged, world.store.stored[render].reason
            world.check_sums(render)
        world.check_nothing_left()


def test_any_order_of_things_leaves_the_bits() -> None:
    """S3, S4: 1,200 of them, each after some others; `make fuzz` tries more."""
    run_state_machine_as_test(Night, settings=settings(tried(EXAMPLES), stateful_step_count=STEPS))
