"""When a render ends: the allowed conditions, and equal bits with tiles that stop by their own error,
whatever happens.

One file, though long: the second half simulates renders by the conditions that the first half reads."""

import math
import random
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.forecast import UNKNOWN, Measured, forecast
from nocturne_coordinator.dispatch.records import OpenRender, RenderState, TileRow, Totals
from nocturne_coordinator.dispatch.result_handler import ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_coordinator.dispatch.state import Settings, State
from nocturne_coordinator.dispatch.stopping import (
    StopConditions,
    parse_until,
    stop_conditions,
)
from nocturne_coordinator.dispatch.trust import MIN_SAMPLES, samples_to_stop
from nocturne_coordinator.output.images import manifest_text
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import extended_schedule, make_schedule
from nocturne_scene.tile_sums import TileSums

from tests.pictures import samples_of
from tests.sums import sums_of

EVENING = datetime(2026, 11, 21, 18, 0, tzinfo=UTC)


@pytest.mark.parametrize(
    ("text", "now", "expected"),
    [
        ("2026-11-22T07:00:00Z", EVENING, "2026-11-22T07:00:00+00:00"),
        ("2026-11-22T07:00+01:00", EVENING, "2026-11-22T06:00:00+00:00"),
        ("07:00 Europe/Berlin", EVENING, "2026-11-22T06:00:00+00:00"),
        ("19:30 Europe/Berlin", EVENING, "2026-11-21T18:30:00+00:00"),
        ("18:30 Europe/Berlin", EVENING, "2026-11-22T17:30:00+00:00"),
        ("7:00 America/New_York", EVENING, "2026-11-22T12:00:00+00:00"),
        ("07:00Z", EVENING, "2026-11-22T07:00:00+00:00"),
        ("07:00-0500", EVENING, "2026-11-22T12:00:00+00:00"),
        # The night before 29 March 2026 is an hour short in Berlin: 07:00 is 05:00 UTC, not 06:00.
        ("07:00 Europe/Berlin", datetime(2026, 3, 28, 20, tzinfo=UTC), "2026-03-29T05:00:00+00:00"),
        # And that of 25 October has one more.
        ("07:00 Europe/Berlin", datetime(2026, 10, 24, 20, tzinfo=UTC), "2026-10-25T06:00:00+00:00"),
    ],
)
def test_a_clock_time_is_the_next_in_its_zone(text: str, now: datetime, expected: str) -> None:
    assert datetime.fromtimestamp(parse_until(text, now), UTC).isoformat() == expected


@pytest.mark.parametrize(
    "text",
    [
        *("07:00", "2026-11-22T07:00:00", "soon", "25:00 Europe/Berlin", "07:00 Europe/Nowhere"),
        *("07:00 ../../etc", "2026-11-21T17:00:00Z", "2028-11-21T17:00:00Z", "07:00 " + "x" * 300),
    ],
)
def test_a_time_without_zone_or_sense_is_refused(text: str) -> None:
    with pytest.raises(InputError) as caught:
        stop_conditions({"until": text}, EVENING)
    assert [each.place for each in caught.value.problems] == ["$.stop.until"]


@pytest.mark.parametrize("value", [-1.0, math.inf, math.nan, 1e30, "1"])
def test_numbers_that_make_no_sense_are_refused(value: Any) -> None:
    names = ["relative_error", "tile_relative_error", "wall_seconds", "cpu_seconds"]
    with pytest.raises(InputError) as caught:
        stop_conditions(dict.fromkeys([*names, "patience"], value), EVENING)
    places = [each.place for each in caught.value.problems]
    assert sorted(places) == sorted(f"$.stop.{name}" for name in [*names, "patience"])


def test_conditions_come_back_from_json() -> None:
    asked: Mapping[str, Any] = {"relative_error": 0.01, "until": "07:00 Europe/Berlin", "cpu_seconds": 3600}
    stop = stop_conditions(asked, EVENING)
    assert StopConditions.from_json(stop.to_json()) == stop
    manifest = StopConditions(tile_samples=(4, 8))
    assert StopConditions.from_json(manifest.to_json()) == manifest
    assert StopConditions().to_json() == "{}"
    # The same words on another day are the same request.
    later = stop_conditions(asked, datetime(2026, 11, 25, 18, tzinfo=UTC))
    assert later.until != stop.until
    assert later.request() == stop.request()


def test_a_manifest_comes_back_from_its_text() -> None:
    for samples in ([4], [4, 4, 4], [8, 4, 4, 0, 0, 0, 8], list(range(9))):
        assert samples_of(manifest_text(samples)) == samples
    assert manifest_text([64, 64, 64, 128, 64]) == "64x3 128 64"


def test_an_error_falls_as_one_over_the_root() -> None:
    """And a stop is expected at the end of the range after the one that has it."""
    ends = [MIN_SAMPLES << doubled for doubled in range(10)]

    def known(error: float) -> ErrorEstimate:
        return ErrorEstimate(error, 1.0, effective_pixels=1e4, pixels=10_000, samples=128)

    assert samples_to_stop(known(0.039), 128, 0.01, ends) == 4096
    assert samples_to_stop(known(0.0), 128, 0.01, ends) == math.inf
    assert samples_to_stop(known(1.0), 128, 0.01, ends) == math.inf
    # The error is reached already: the tile stops at the end of the range in flight.
    assert samples_to_stop(known(1e-9), 128, 0.01, ends) == 256


def measured(**changes: Any) -> Measured:
    values: dict[str, Any] = {
        "photons": 1000,
        "photons_wanted": 5000.0,
        "mean_samples": 64.0,
        "estimate": ErrorEstimate(0.1, 1.0, effective_pixels=1e4, pixels=10_000, samples=64),
        "range_ends": [32, 64, 128, 256, 320],
        "photons_per_second": 100.0,
        "cpu_seconds": 20.0,
        "ran_seconds": 10.0,
    }
    return Measured(**(values | changes))


@pytest.mark.parametrize(
    ("stop", "seconds", "cpu_seconds"),
    [
        (StopConditions(), 40.0, 100.0),
        # Of the error, 0.72 is twice the samples, and one range more; a tenth of it is more than all that are
        # planned.
        (StopConditions(relative_error=0.072), 30.0, 80.0),
        (StopConditions(relative_error=0.01), 40.0, 100.0),
        (StopConditions(wall_seconds=15.0), 5.0, 30.0),
        (StopConditions(cpu_seconds=60.0), 20.0, 60.0),
        (StopConditions(until=1007.0, cpu_seconds=60.0), 7.0, 34.0),
        (StopConditions(until=900.0), 0.0, 20.0),
    ],
)
def test_the_first_condition_is_foreseen(stop: StopConditions, seconds: float, cpu_seconds: float) -> None:
    foreseen = forecast(measured(), stop, 1000.0)
    assert foreseen.end == pytest.approx(1000.0 + seconds)
    assert foreseen.cpu_seconds == pytest.approx(cpu_seconds)


def test_nothing_is_foreseen_without_a_rate() -> None:
    assert forecast(measured(photons_per_second=0.0), StopConditions(until=5.0), 0.0) == UNKNOWN
    assert forecast(measured(photons=0), StopConditions(), 0.0) == UNKNOWN


def test_an_extended_plan_begins_with_the_old_one() -> None:
    old = make_schedule(70, 33, 50)
    extended = extended_schedule(old, 300)
    assert list(extended.range_ends) == [4, 8, 16, 32, 50, 64, 128, 256, 300]
    # Where the old one ends at a power of two, nothing tells the two schedules apart.
    assert extended_schedule(make_schedule(70, 33, 64, ["rod"]), 300) == make_schedule(70, 33, 300, ["rod"])
    assert extended_schedule(old, 50) == old
    with pytest.raises(InputError):
        extended_schedule(old, 49)


# --- tiles that stop by their own error ---

NOISE = (0.02, 0.1, 0.3, 0.6, 1.0, 0.0)
"""Of each tile: standard deviation of Y relative to its mean; the last one is black."""


def noisy_sums(job: job_pb2.Job) -> TileSums:
    """Sums of normally distributed samples around 10 cd/m2, by a generator that knows the job only."""
    shape = (job.tile.height, job.tile.width)
    noise = NOISE[job.tile_index]
    if noise == 0.0:
        return TileSums.zeros(job.tile.width, job.tile.height)
    count = job.end_sample - job.first_sample
    draws = np.random.default_rng([job.tile_index, job.first_sample]).normal(
        10.0, 10.0 * noise, (count, *shape)
    )
    return sums_of(np.abs(draws)[..., None].repeat(3, axis=-1))


class Adaptive:
    """The coordinator's core on a render whose tiles stop at an error; a stream that can be shuffled and
    lost."""

    def __init__(self, stop: StopConditions, samples: int = 1024, tiles: list[TileRow] | None = None) -> None:
        schedule = make_schedule(70, 33, samples)
        row = OpenRender(
            "r", RenderState.RUNNING, schedule, "5c" * 32, job_pb2.ENGINE_CURRENT, Totals(), stop
        )
        self.render = RunningRender(row, tiles or [])
        self.scheduler = Scheduler()
        self.scheduler.add("r", self.render.range_queues())
        state = State(Settings(), self.scheduler, Auditor(0.0, 0.0), {"r": self.render})
        self.intake = ResultHandler(state)
        self.stream: dict[bytes, JobKey] = {}
        self.entries = 0
        self.traced = 0

    def fill(self, window: int) -> None:
        for key in self.scheduler.take(window - self.scheduler.in_flight):
            self.entries += 1
            self.scheduler.published(key, b"%d" % self.entries, 0.0)
            self.stream[b"%d" % self.entries] = key

    def finish(self, entry: bytes) -> bytes:
        key = self.stream.pop(entry)
        planned = self.render.planned
        job = planned.job(key.tile_index, planned.ranges[key.range_index])
        pixels = job.tile.width * job.tile.height * (job.end_sample - job.first_sample)
        self.traced += pixels
        partial = job_pb2.Partial(sums=noisy_sums(job).encode(), photons=pixels)
        result = job_pb2.JobResult(job=job, worker_id="w", partial=partial).SerializeToString()
        self.deliver(result)
        return result

    def deliver(self, result: bytes) -> None:
        for gone in self.intake.take(b"0-1", result, 1.0, 0.5).withdrawn:
            self.stream.pop(gone, None)

    def committed(self) -> list[TileRow]:
        film = self.render.film
        return [
            TileRow(index, film.samples(index), film.tile_bytes(index), error_before=film.error_before(index))
            for index, tile in enumerate(film.queues)
            if tile.merged
        ]


def adaptive_run(seed: int, window: int, stop: StopConditions) -> Adaptive:
    """Runs to the end with results shuffled, repeated, lost, and the coordinator restarted."""
    chance = random.Random(seed)
    session = Adaptive(stop)
    results = []
    for _ in range(5_000):
        session.fill(window)
        if session.render.film.complete:
            return session
        if session.stream:
            results.append(session.finish(chance.choice(list(session.stream))))
        if chance.random() < 0.1:
            session.deliver(chance.choice(results))
        if chance.random() < 0.03:
            session.stream.clear()
            session.scheduler.lost()
        if chance.random() < 0.02:
            session = Adaptive(stop, tiles=session.committed())
    raise AssertionError("it never ends")


def in_order(tile: job_pb2.Tile, index: int, samples: int) -> TileSums:
    """What one process that traces range by range has at the end."""
    planned = Adaptive(StopConditions()).render.planned
    total = TileSums.zeros(tile.width, tile.height)
    for position in range(planned.ranges.merged_at(samples)):
        total += noisy_sums(planned.job(index, planned.ranges[position]))
    return total


@pytest.mark.parametrize("seed", range(4))
def test_adaptive_tiles_have_the_same_bits_whatever_happens(seed: int) -> None:
    stop = StopConditions(tile_relative_error=0.02)
    calm = adaptive_run(0, 1, stop)
    stormy = adaptive_run(seed + 1, 24, stop)
    assert np.array_equal(stormy.render.film.sums, calm.render.film.sums)
    assert np.array_equal(stormy.render.film.counts, calm.render.film.counts)
    assert stormy.scheduler.in_flight == 0
    for index, samples in enumerate(stormy.render.film.manifest()):
        tile = stormy.render.planned.grid.tile(index)
        assert stormy.render.film.tile_bytes(index) == in_order(tile, index, samples).encode()


def test_noisy_tiles_get_the_work() -> None:
    session = adaptive_run(0, 1, StopConditions(tile_relative_error=0.02))
    samples = session.render.film.manifest()
    # An error of s / sqrt(n) falls below 0.02 at n = (s / 0.02)^2: at 1, 25, 225, 900, 2500 samples; tiles
    # stop at the second end of a range from there on, none before 64. The estimate of 1024 pixels is good to
    # a few per cent, which no distance to the next end is. (|Y| of the noisiest is folded, so its error is a
    # little lower: 1024 is the cap.)
    assert samples == [64, 64, 512, 1024, 1024, 1024]
    full = StopConditions()
    everything = adaptive_run(0, 1, full)
    assert session.render.totals.photons < everything.render.totals.photons
    # A tile that is black so far may just not have met its light.
    assert session.render.film.queues[5].sums.pixels.sum() == 0.0


def test_little_is_traced_in_vain() -> None:
    """With all ranges of all tiles on the stream at once, the horizon holds back what tiles should not
    need."""
    session = adaptive_run(0, 1000, StopConditions(tile_relative_error=0.02))
    counted = session.render.totals.photons
    one_by_one = adaptive_run(0, 1, StopConditions(tile_relative_error=0.02))
    assert one_by_one.render.totals.photons == counted


def test_a_manifest_gives_exactly_its_samples() -> None:
    adaptive = adaptive_run(7, 12, StopConditions(tile_relative_error=0.02))
    manifest = tuple(adaptive.render.film.manifest())
    for samples in (manifest, (0, *manifest[1:])):
        replayed = adaptive_run(9, 24, StopConditions(tile_samples=samples))
        assert tuple(replayed.render.film.manifest()) == samples
        again = slice(None) if samples == manifest else slice(32, None)
        assert np.array_equal(replayed.render.film.sums[:, again], adaptive.render.film.sums[:, again])


def running(session: Adaptive, stop: StopConditions, totals: Totals, ran_seconds: float = 0.0) -> OpenRender:
    schedule = session.render.planned.schedule
    return OpenRender(
        "r",
        RenderState.RUNNING,
        schedule,
        "5c" * 32,
        job_pb2.ENGINE_CURRENT,
        totals,
        stop,
        ran_seconds=ran_seconds,
    )


def at(stop: StopConditions, samples: Sequence[int]) -> list[RenderState | None]:
    """How a render stands that is looked at when all its tiles have so many samples, one after the other."""
    found: list[RenderState | None] = []
    render: RunningRender | None = None
    for each in samples:
        session = adaptive_run(0, 1, StopConditions(tile_samples=(each,) * 6))
        if render is None:
            render = RunningRender(running(session, stop, Totals()), session.committed())
        for tile in session.committed():
            render.film.load(tile.tile_index, tile.samples, tile.sums)
        render.film.loaded()
        render.totals.photons = session.render.totals.photons
        render.error_point(0.0)
        ending = render.ending(0.0, 0.0)
        found.append(ending[0] if ending else None)
    return found


def test_an_image_ends_when_two_range_ends_in_a_row_have_its_error() -> None:
    """An error of about 0.15 / sqrt(n): 0.0133 with 128 samples."""
    open_, done = None, RenderState.SUCCEEDED
    asked = StopConditions(relative_error=0.012)
    assert at(asked, [64, 128, 256, 512]) == [open_, open_, open_, done]
    assert at(asked, [512]) == [open_]
    assert at(asked, [512, 512]) == [open_, open_]
    # Too few samples, however low the error.
    assert at(StopConditions(relative_error=0.5), [8, 16, 32]) == [open_, open_, open_]


def test_times_end_a_render() -> None:
    def ending(stop: StopConditions, **state: float) -> tuple[str, str] | None:
        session = adaptive_run(0, 1, StopConditions(tile_samples=(64,) * 6))
        row = running(session, stop, Totals(cpu_seconds=50.0), ran_seconds=100.0)
        render = RunningRender(row, session.committed(), now=1000.0)
        found = render.ending(state.get("now", 1000.0), state.get("unix_time", 5e8))
        return None if found is None else (found[0].value, found[1])

    assert ending(StopConditions(wall_seconds=120.0), now=1019.0) is None
    assert ending(StopConditions(wall_seconds=120.0), now=1020.0) == (
        "STOPPED_EARLY",
        "Stopped after 120 s of running, as asked.",
    )
    assert ending(StopConditions(cpu_seconds=50.1)) is None
    assert (ending(StopConditions(cpu_seconds=50.0)) or "")[0] == "STOPPED_EARLY"
    assert ending(StopConditions(until=6e8, until_text="07:00Z"), unix_time=5.9e8) is None
    assert ending(StopConditions(until=6e8, until_text="07:00Z"), unix_time=6e8) == (
        "STOPPED_EARLY",
        "Stopped at 07:00Z, as asked.",
    )
