"""Bytes from workers or others reach an accumulator only if they are a possible result of a published job."""

import math
import random
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.queue.worker_status import worker_row
from nocturne_scene.tile_sums import XYZ_SUMS, TileSums, split

from tests.coordinator.simulated_worker import simulated_result
from tests.coordinator.test_merging import Session
from tests.fuzzing import tried
from tests.mutations import mutated

Spoil = Callable[[job_pb2.JobResult], None]


def changed_sums(change: Callable[[TileSums], None]) -> Spoil:
    def spoil(result: job_pb2.JobResult) -> None:
        tile = result.job.tile
        numbers = np.frombuffer(result.partial.sums).copy()
        change(split(numbers, tile.width, tile.height, 0))
        result.partial.sums = numbers.tobytes()

    return spoil


def put(pixel: int, channel: int, value: float) -> Spoil:
    return changed_sums(lambda sums: sums.pixels.reshape(-1, XYZ_SUMS).__setitem__((pixel, channel), value))


def scaled(part: str, factor: float) -> Spoil:
    return changed_sums(lambda sums: getattr(sums, part).__imul__(factor))


def field(path: str, value: object) -> Spoil:
    def spoil(result: job_pb2.JobResult) -> None:
        *parents, name = path.split(".")
        message: object = result
        for parent in parents:
            message = getattr(message, parent)
        setattr(message, name, value)

    return spoil


SPOILT: dict[str, Spoil] = {
    "NaN": put(0, 0, float("nan")),
    "infinite": put(3, 2, float("inf")),
    "negative": put(1, 1, -1e-9),
    "beyond physics": put(1, 0, 1e200),
    "Y without Y squared": put(5, 3, 0.0),
    "X without X squared": put(5, 4, 0.0),
    "Z without Z squared": put(5, 5, 0.0),
    "XY above the roots of XX and YY": put(5, 6, 1e6),
    "XZ above the roots of XX and ZZ": put(5, 7, 1e6),
    "YZ above the roots of YY and ZZ": put(5, 8, 1e6),
    "blocks with less than their pixels": scaled("block_products", 0.01),
    "blocks with more than their pixels": scaled("block_products", 100.0),
    "a tile with less than its blocks": scaled("tile_products", 0.001),
    "a tile with more than its blocks": scaled("tile_products", 1000.0),
    "a tile of NaN": scaled("tile_products", float("nan")),
    "truncated": lambda result: setattr(result.partial, "sums", result.partial.sums[:-1]),
    "too long": lambda result: setattr(result.partial, "sums", result.partial.sums + bytes(32)),
    "no sums": field("partial.sums", b""),
    "photons": field("partial.photons", 1),
    "invalid_samples": field("partial.invalid_samples", 2**40),
    "rays": field("partial.rays", 2**63),
    "cpu_seconds NaN": field("partial.cpu_seconds", float("nan")),
    "cpu_seconds negative": field("partial.cpu_seconds", -1.0),
    "render": field("job.render_id", "other"),
    "tile index": field("job.tile_index", 77),
    "other tile": field("job.tile_index", 1),
    "tile rectangle": field("job.tile.width", 2**31),
    "range": field("job.end_sample", 7),
    "range upside down": field("job.first_sample", 16),
    "film": field("job.film_width", 71),
    "scene": field("job.scene", b"\x00" * 32),
    "engine": field("job.engine", 1),
    "no outcome": lambda result: result.ClearField("partial"),
    "no job": lambda result: result.ClearField("job"),
}


@pytest.mark.parametrize("spoil", SPOILT.values(), ids=list(SPOILT))
def test_an_impossible_result_changes_nothing_and_its_range_comes_again(spoil: Spoil) -> None:
    session = Session(samples=20)
    session.fill(6)
    key = next(iter(session.stream))
    result = session.result(key)
    spoil(result)
    assert session.deliver(result.SerializeToString()) == [b"0-1"]
    assert not session.render.film.sums.any()
    assert session.render.totals.photons == 0
    # The range is out still, or it is the next to be published.
    session.fill(6)
    assert key in session.stream
    session.deliver(session.result(key).SerializeToString())
    assert session.render.totals.ranges == 1


def test_what_is_refused_is_named_in_the_log() -> None:
    session = Session(samples=20)
    session.fill(6)
    key = next(iter(session.stream))
    result = session.result(key)
    result.worker_id = "w1"
    SPOILT["NaN"](result)
    session.deliver(result.SerializeToString())
    refused, failed = session.lines
    assert "render=r worker=w1: " in refused
    assert failed.startswith(f"render=r tile={key.tile_index} range={key.range_index} failed at worker=w1: ")


@pytest.mark.parametrize(("planned", "sent"), [(0, 1), (1, 0), (2, 1), (1, 2)])
def test_sums_of_other_responses_than_planned_are_refused(planned: int, sent: int) -> None:
    session = Session(samples=4, further_responses=["rod", "cone"][:planned])
    session.fill(6)
    key = next(iter(session.stream))
    render = session.render.planned
    job = render.job(key.tile_index, render.ranges[key.range_index])
    session.deliver(simulated_result(job, further_responses=sent).SerializeToString())
    assert session.intake.refused == 1
    assert session.render.totals.photons == 0


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e-9, 1e200])
def test_further_responses_are_checked_as_x_and_z_are(value: float) -> None:
    session = Session(samples=4, further_responses=["rod"])
    session.fill(6)
    key = next(iter(session.stream))
    result = session.result(key)
    sums = np.frombuffer(result.partial.sums).copy()
    sums[9] = value
    result.partial.sums = sums.tobytes()
    session.deliver(result.SerializeToString())
    assert session.intake.refused == 1
    assert session.render.totals.photons == 0


@given(st.binary(max_size=200))
def test_any_bytes_are_survived(data: bytes) -> None:
    session = Session(samples=4)
    session.fill(6)
    assert session.deliver(data) == [b"0-1"]
    assert session.render.totals.ranges == 0


@tried(examples=100)
@given(st.integers(0, 2**32))
@example(2613038)  # the job names a floating-point profile before the render has one
def test_results_that_are_almost_right_are_survived(seed: int) -> None:
    session = Session(samples=4)
    session.fill(6)
    key = next(iter(session.stream))
    right = session.result(key)
    data = mutated(right, random.Random(seed))
    session.deliver(data)
    sums = session.render.film.sums
    assert np.isfinite(sums).all()
    # A merged result has the published job, in every field.
    if session.render.totals.ranges:
        told = job_pb2.JobResult.FromString(data).job
        # The time limit is not part of the job's identity.
        told.max_cpu_seconds = right.job.max_cpu_seconds
        assert told == right.job


@tried(examples=100)
@given(st.integers(0, 2**32))
def test_any_word_of_a_worker_is_shown_or_dropped(seed: int) -> None:
    status = job_pb2.WorkerStatus(worker_id="w", engine=job_pb2.ENGINE_CURRENT, threads=4, started=1e9)
    row = worker_row("w", mutated(status, random.Random(seed)), 0.0)
    if row is not None:
        assert 1 <= len(row.id) <= 128
        assert math.isfinite(row.photons_per_second)
        assert max(row.photons, row.rays, row.jobs_done) < 2**63


def test_workers_that_send_nonsense_for_ever_end_the_render() -> None:
    session = Session(samples=4)
    for tile in range(6):
        for _ in range(limits.DISTINCT_WORKERS):
            assert not session.failed
            session.fill(6)
            result = session.result(next(key for key in session.stream if key.tile_index == tile))
            result.partial.photons = 3
            session.deliver(result.SerializeToString())
    assert "3 photons; expected" in session.failed["r"]
    assert sorted(session.render.failed_tiles) == list(range(6))
    assert session.scheduler.in_flight == 0
    assert session.render.totals.refused == 6 * limits.DISTINCT_WORKERS


def test_one_machine_that_enrolled_can_not_end_a_render_by_what_it_says() -> None:
    """P5: tiles that it says it can't do get no more samples, and a resumed render tries them again."""
    session = Session(samples=4, settings=Settings(enrolled=True))
    for tile in range(6):
        for _ in range(limits.DISTINCT_WORKERS):
            session.fill(6)
            result = session.result(next(key for key in session.stream if key.tile_index == tile))
            result.failure = "no such scene"
            session.deliver(result.SerializeToString())
    assert sorted(session.render.failed_tiles) == list(range(6))
    assert session.failed == {}


def test_a_failure_counts_once_per_attempt() -> None:
    session = Session(samples=4)
    session.fill(6)
    key = next(iter(session.stream))
    result = session.result(key)
    result.failure = "no such scene"
    for attempt in range(limits.DISTINCT_WORKERS):
        assert not session.render.failed_tiles, attempt
        session.fill(6)
        session.deliver(result.SerializeToString())
        # Delivered twice: the job is not out now, so this is no attempt.
        session.deliver(result.SerializeToString())
    assert session.render.failed_tiles[key.tile_index].reason == "no such scene"
    assert key not in session.stream


def test_all_that_die_of_a_job_at_once_count() -> None:
    """Each had a copy of it. The first death takes it off the stream; it is published again once."""
    session = Session(4)
    session.fill(6)
    key = next(iter(session.stream))
    outcomes = [
        session.intake.lost_worker(key, worker, 0.0) for worker in ("worker-1", "worker-2", "worker-3")
    ]
    assert [[line.message.split()[-4] for line in outcome.lines] for outcome in outcomes] == [
        ["worker-1"],
        ["worker-2"],
        ["worker-3"],
    ]
    assert session.scheduler.take(100).count(key) == 1
