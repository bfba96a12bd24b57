"""Forward photons in separate ranges: merged in order, shown with tiles' samples, committed seldom.

The file is long because all of its tests look at one render with both kinds of ranges, which is made here."""

import zlib
from dataclasses import replace

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.forward_photons import photon_commit_seconds
from nocturne_coordinator.dispatch.merge import MergeResult, RangeSums
from nocturne_coordinator.dispatch.planned_render import PlannedRender, RejectedResult
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.records import OpenRender, RenderCommit, RenderState, TileRow, Totals
from nocturne_coordinator.dispatch.result_handler import ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_coordinator.dispatch.state import Settings, State
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.photon_sums import with_photons
from nocturne_scene.ranges import PHOTON_BUNDLE, ForwardPhotons, make_schedule
from nocturne_scene.tile_sums import numbers_in

from tests.coordinator.service import SCENE
from tests.coordinator.simulated_worker import simulated_sums

# Four tiles; the number of photons is that of a film large enough for separate photon ranges.
WIDTH, HEIGHT = 40, 36
TILES = 4
PHOTONS = TILES


@pytest.fixture
def schedule() -> job_pb2.RangeSchedule:
    schedule = make_schedule(WIDTH, HEIGHT, 8)
    schedule.photon_range_ends.extend([1, 2, 4])
    return schedule


def _running(schedule: job_pb2.RangeSchedule, stop: StopConditions = EVERYTHING) -> RunningRender:
    row = OpenRender("r", RenderState.RUNNING, schedule, SCENE, 1, Totals(), stop)
    return RunningRender(row, [])


def _photon_bytes(value: int) -> bytes:
    """Of a film on which every pixel has the same, with some rest of squares."""
    pixels = WIDTH * HEIGHT
    whole = np.full(pixels, value, dtype=">f4").view(np.uint8).reshape(-1, 4)
    planes = [whole[:, byte].tobytes() for byte in range(4)]
    products = (numbers_in(WIDTH, HEIGHT, 0) - 9 * pixels) // 6 + TILES - 1
    square = np.full(6 * (pixels + products), value, dtype=">f4").view(np.uint8).reshape(-1, 4)
    # Kinds follow each other, each by its bytes.
    parts = [*planes * 3]
    for count in [pixels] * 6 + [products - TILES] * 6 + [TILES] * 6:
        parts += [square[:count, byte].tobytes() for byte in range(2)]
    return zlib.compress(b"".join(parts))


def _photons(planned: PlannedRender, index: int, value: int = 1) -> RangeSums:
    found = planned.ranges_of(PHOTONS)[index]
    count = (found.end - found.first) * PHOTON_BUNDLE
    partial = job_pb2.Partial(sums=_photon_bytes(value), photons=count, rays=count)
    sums = planned.check_partial(partial, planned.job(PHOTONS, found))
    return RangeSums(index, sums, count, count, 0, 1.0, b"photons-%d" % index)


def _samples(planned: PlannedRender, tile: int, index: int) -> RangeSums:
    job = planned.job(tile, planned.ranges_of(tile)[index])
    photons = planned.photons_in(tile, planned.ranges_of(tile)[index])
    entry = b"tile-%d-%d" % (tile, index)
    return RangeSums(index, simulated_sums(job, 0), photons, 3 * photons, 0, 0.1, entry)


def _merge_all(render: RunningRender) -> None:
    for index in range(3):
        render.offer(PHOTONS, _photons(render.planned, index), 0.0)
    for tile in range(TILES):
        for index in range(2):
            render.offer(tile, _samples(render.planned, tile, index), 0.0)


def test_nothing_is_shown_until_both_kinds_of_photons_came(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule)
    render.offer(0, _samples(render.planned, 0, 0), 0.0)
    assert not render.film.counts.any()
    assert not render.film.sums.any()
    assert render.film.shown_bytes(0) == b""
    render.offer(PHOTONS, _photons(render.planned, 0), 0.0)
    assert (render.film.counts > 0).sum() == 32 * 32
    assert (render.film.counts[:32, :32] == 4).all()
    assert render.film.shown_bytes(0) != b""
    assert render.film.shown_bytes(1) == b""


def test_photon_ranges_are_merged_in_order_and_once(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule)
    verdicts = [render.offer(PHOTONS, _photons(render.planned, i, i + 1), 0.0).verdict for i in (1, 0, 1, 2)]
    assert verdicts == [MergeResult.EARLY, MergeResult.MERGED, MergeResult.DUPLICATE, MergeResult.MERGED]
    assert render.film.manifest()[PHOTONS] == 4
    assert render.totals.photons == 4 * PHOTON_BUNDLE
    assert render.film.mean_samples == 0.0


def test_what_is_shown_are_the_sums_of_both(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule)
    _merge_all(render)
    film = render.film
    tile = film.queues[3].sums
    photons = film.queues[PHOTONS].sums
    part = replace(
        photons,
        pixels=photons.pixels[32:, 32:],
        block_products=photons.block_products[8:, 8:],
        tile_products=photons.tile_products[3:],
    )
    expected = with_photons(tile, 8, part, 4, WIDTH * HEIGHT)
    np.testing.assert_array_equal(film.sums[32:, 32:], expected.pixels)
    np.testing.assert_array_equal(film.squares.of_blocks[8:, 8:], expected.block_products)
    np.testing.assert_array_equal(film.squares.of_tiles[1, 1], expected.tile_products[0])
    assert film.complete
    assert film.mean_samples == 8


def test_photons_are_committed_seldom_and_their_results_kept_until_then(
    schedule: job_pb2.RangeSchedule,
) -> None:
    render = _running(schedule)
    render.offer(PHOTONS, _photons(render.planned, 0), 0.0)
    render.offer(0, _samples(render.planned, 0, 0), 0.0)
    seconds = photon_commit_seconds(WIDTH * HEIGHT)
    early = render.changes(0.2 * seconds, 1.0)
    assert early is not None
    assert [(row.tile_index, bool(row.photons)) for row in early.tiles] == [(0, False)]
    assert render.committed() == []
    assert render.waiting_entries() == [b"photons-0"]
    # The first one is sooner.
    due = render.changes(0.25 * seconds, 1.0)
    assert due is not None
    rows = list(due.tiles)
    assert [row.tile_index for row in rows] == [0, 1, 2, 3, PHOTONS]
    assert all(row.photons for row in rows[:-1])
    assert rows[-1].samples == due.photon_bundles == 1
    assert render.committed() == [b"photons-0"]
    assert render.waiting_entries() == []
    render.offer(PHOTONS, _photons(render.planned, 1), 0.0)
    early, due = render.changes(1.2 * seconds, 1.0), render.changes(1.3 * seconds, 1.0)
    assert early is None or PHOTONS not in [row.tile_index for row in early.tiles]
    assert due is not None
    assert PHOTONS in [row.tile_index for row in due.tiles]


def test_large_films_are_committed_more_seldom() -> None:
    assert [photon_commit_seconds(edge**2) for edge in (64, 256, 512, 4096)] == [2.0, 4.0, 16.0, 30.0]


def test_a_render_goes_on_with_what_was_committed(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule)
    for index in range(2):
        render.offer(PHOTONS, _photons(render.planned, index), 0.0)
    for tile in range(TILES):
        render.offer(tile, _samples(render.planned, tile, 0), 0.0)
    render.commit_photons_next()
    commit = render.changes(1.0, 1.0)
    assert commit is not None
    again = RunningRender(render.row, reversed([*commit.tiles]))
    assert again.film.manifest() == render.film.manifest() == [4, 4, 4, 4, 2]
    assert again.totals.photons == render.totals.photons
    np.testing.assert_array_equal(again.film.sums, render.film.sums)
    np.testing.assert_array_equal(again.film.counts, render.film.counts)
    np.testing.assert_array_equal(
        again.film.queues[PHOTONS].sums.pixels, render.film.queues[PHOTONS].sums.pixels
    )


@pytest.mark.parametrize("asked", [0.0, 0.5, 1e-9])
def test_a_schedule_that_grows_leaves_a_render_as_a_restart_would(
    schedule: job_pb2.RangeSchedule, asked: float
) -> None:
    render = _running(schedule)
    _merge_all(render)
    render.offer(PHOTONS, _photons(render.planned, 0), 0.0)
    render.commit_photons_next()
    commit = render.changes(1.0, 1.0)
    assert commit is not None
    longer = job_pb2.RangeSchedule()
    longer.CopyFrom(schedule)
    longer.range_ends.append(16)
    longer.photon_range_ends.append(8)
    row = replace(render.row, schedule=longer, stop=StopConditions(tile_relative_error=asked))
    again = RunningRender(row, reversed([*commit.tiles]))
    assert render.can_replan(row)
    assert render.replan(row) == []
    assert render.film.manifest() == again.film.manifest()
    assert render.film.complete == again.film.complete
    assert render.film.expected_samples == again.film.expected_samples
    assert render.range_queues() == again.range_queues()
    np.testing.assert_array_equal(again.film.sums, render.film.sums)
    np.testing.assert_array_equal(again.film.counts, render.film.counts)


def test_at_the_end_all_is_committed_at_once(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule)
    _merge_all(render)
    commit = render.changes(1.0, 1.0)
    assert commit is not None
    assert len(commit.tiles) == TILES + 1


def test_ranges_of_photons_that_take_too_long_are_cut(schedule: job_pb2.RangeSchedule) -> None:
    schedule.photon_range_ends[:] = [1, 2, 4, 8, 16, 48]
    render = _running(schedule)
    render.offer(PHOTONS, replace(_photons(render.planned, 0), cpu_seconds=5.0), 0.0)
    recut = render.recut()
    assert recut is not None
    # 32 bundles would take 160 s; those that take less than half a minute stay together.
    assert list(recut.photon_range_ends) == [1, 2, 4, 8, 12, 16, *range(20, 49, 4)]
    assert recut.range_ends == schedule.range_ends


def test_photons_end_when_no_tile_needs_more(schedule: job_pb2.RangeSchedule) -> None:
    render = _running(schedule, StopConditions(tile_relative_error=0.5))
    for tile in range(TILES):
        render.film.give_up(tile)
    assert not render.film.complete
    render.offer(PHOTONS, _photons(render.planned, 0), 0.0)
    assert render.film.complete


@pytest.fixture
def alone() -> job_pb2.RangeSchedule:
    schedule = make_schedule(WIDTH, HEIGHT, 8, forward_photons=ForwardPhotons.ALONE)
    schedule.photon_range_ends[:] = [1, 2, 4, 8, 16, 32, 64]
    return schedule


def _taken_up_again(render: RunningRender) -> RunningRender:
    render.commit_photons_next()
    commit = render.changes(1.0, 1.0)
    assert commit is not None
    assert commit.photon_bundles == 0, "its photons are samples of pixels"
    return RunningRender(render.row, reversed([*commit.tiles]))


def test_forward_photons_alone_are_the_image(alone: job_pb2.RangeSchedule) -> None:
    """A photon's worth is a pixel's samples over all photons; an image by them has as many samples as pixels
    have photons."""
    render = _running(alone)
    film = render.film
    assert (film.horizon(0), film.horizon(PHOTONS), film.tiles_done) == (0, 7, 0)
    for index in range(3):
        render.offer(PHOTONS, _photons(render.planned, index), 0.0)
    assert (film.counts == 4 * PHOTON_BUNDLE // (WIDTH * HEIGHT)).all()
    assert film.mean_samples == 4 * PHOTON_BUNDLE // (WIDTH * HEIGHT)
    mean = film.sums[..., 1] / film.counts
    np.testing.assert_allclose(mean, 3.0 * WIDTH * HEIGHT / (4 * PHOTON_BUNDLE), rtol=1e-14)
    assert film.manifest() == [0, 0, 0, 0, 4]
    again = _taken_up_again(render)
    assert again.film.manifest() == [0, 0, 0, 0, 4]
    np.testing.assert_array_equal(again.film.sums, film.sums)
    np.testing.assert_array_equal(again.film.counts, film.counts)
    for index in range(3, 7):
        assert not film.complete
        render.offer(PHOTONS, _photons(render.planned, index), 0.0)
    assert film.complete
    assert film.tiles_done == TILES


def test_a_render_fails_with_forward_photons_that_bring_all_light(alone: job_pb2.RangeSchedule) -> None:
    render = _running(alone)
    scheduler = Scheduler()
    scheduler.add("r", render.range_queues())
    state = State(Settings(), scheduler, Auditor(0.0, 0.0), {"r": render})
    handler = ResultHandler(state)
    failed: dict[str, str] = {}
    for worker in ("a", "b", "c"):
        (key,) = scheduler.take(1)
        scheduler.published(key, worker.encode(), 0.0)
        assert not failed
        job = render.planned.job(key.tile_index, render.planned.ranges_of(key.tile_index)[0])
        result = job_pb2.JobResult(job=job, worker_id=worker, failure="no light", floating_point_profile="p")
        failed = handler.take(worker.encode(), result.SerializeToString(), 0.0, 0.5).failed
    assert failed == {"r": "no light"}


def test_forward_photons_alone_end_by_the_error_of_the_film(alone: job_pb2.RangeSchedule) -> None:
    """Where b photons of value 1 fall on each pixel, its error is 1 / sqrt(b): 0.25 by 16, and 0.18 by 32."""
    render = _running(alone, StopConditions(tile_relative_error=0.3))
    for index, bundles in enumerate([1, 1, 2, 4, 8]):
        render.offer(PHOTONS, _photons(render.planned, index, bundles), 0.0)
    assert not render.film.complete
    assert render.film.horizon(PHOTONS) == 6
    render = _taken_up_again(render)
    assert not render.film.complete
    render.offer(PHOTONS, _photons(render.planned, 5, 16), 0.0)
    assert render.film.complete
    assert _taken_up_again(render).film.complete


@pytest.mark.parametrize(
    "spoil",
    [
        lambda partial: partial.MergeFrom(job_pb2.Partial(sums=b"x")),
        lambda partial: partial.MergeFrom(job_pb2.Partial(photons=1)),
        lambda partial: partial.MergeFrom(job_pb2.Partial(sums=_photon_bytes(2**20))),
    ],
)
def test_other_results_are_refused(schedule: job_pb2.RangeSchedule, spoil: object) -> None:
    assert callable(spoil)
    planned = _running(schedule).planned
    found = planned.ranges_of(PHOTONS)[0]
    partial = job_pb2.Partial(sums=_photon_bytes(1), photons=PHOTON_BUNDLE, rays=PHOTON_BUNDLE)
    planned.check_partial(partial, planned.job(PHOTONS, found))
    spoil(partial)
    with pytest.raises(RejectedResult):
        planned.check_partial(partial, planned.job(PHOTONS, found))


def test_both_kinds_go_on_together() -> None:
    """Of a film of two million pixels: forward photons first, then the tiles that begin as late."""
    schedule = make_schedule(1920, 1080, 64, forward_photons=ForwardPhotons.BESIDE)
    planned = PlannedRender("r", schedule, b"", job_pb2.ENGINE_CURRENT)
    scheduler = Scheduler()
    tiles = planned.grid.count
    counts = [len(planned.ranges_of(index)) for index in range(tiles + 1)]
    turns = [planned.turns_of(index) for index in range(tiles + 1)]
    scheduler.add(
        "r", [RangeQueue(bytearray(count), turns=of) for count, of in zip(counts, turns, strict=True)]
    )
    order: list[JobKey] = []
    while keys := scheduler.take(1):
        order.extend(keys)
        scheduler.published(keys[0], b"", 0.0)
        scheduler.received(keys[0], 0.0)
        scheduler.completed("r", keys[0].tile_index, keys[0].range_index + 1)
    assert len(order) == len(set(order)) == sum(counts)
    assert order[0] == JobKey("r", tiles, 0)
    last = 0.0
    for key in order:
        first = planned.ranges_of(key.tile_index)[key.range_index].first
        if key.tile_index < tiles:
            last = max(last, first)
        else:
            # No range of a tile that begins later went before.
            assert last <= first * PHOTON_BUNDLE / planned.pixels


def _stored(folder: DataFolder, ledger: Ledger, schedule: job_pb2.RangeSchedule) -> tuple[str, int]:
    """A render that runs; its id and fence."""
    new = NewRender("a", "name", SCENE, "{}", WIDTH, HEIGHT, 8, schedule)
    render_id = folder.renders.create(new).id
    taken = ledger.renders.take(render_id)
    assert taken is not None
    assert ledger.commits.start(render_id, taken.fence, 1.0)
    return render_id, taken.fence


def _commit(
    ledger: Ledger, render: tuple[str, int], rows: list[TileRow], workers: dict[int, list[str]]
) -> None:
    commit = RenderCommit(*render, rows, Totals(), 0.0, contributors=workers, photon_bundles=1)
    assert ledger.commits.commit([commit]) == []


def test_what_a_commit_leaves_out_stays(
    folder: DataFolder, ledger: Ledger, schedule: job_pb2.RangeSchedule
) -> None:
    render = _stored(folder, ledger, schedule)
    _commit(ledger, render, [TileRow(0, 4, b"", own=b"own"), TileRow(2, 0, b"", photons=b"p")], {})
    assert folder.tiles.changed(render[0], (0, -1), 9) == []
    both = TileRow(0, 4, b"both", photons=b"photons")
    _commit(ledger, render, [both, TileRow(PHOTONS, 1, b"")], {})
    _commit(ledger, render, [TileRow(0, 8, b"later", own=b"more")], {})
    expected = [
        TileRow(PHOTONS, 1, b""),
        TileRow(2, 0, b"", photons=b"p"),
        TileRow(0, 8, b"later", own=b"more", photons=b"photons"),
    ]
    assert list(ledger.renders.tiles(render[0])) == expected
    assert [each.tile_index for each in folder.tiles.changed(render[0], (0, -1), 9)] == [0]
    assert folder.tiles.manifest(render[0]) == (8, 0, 0, 0, 1)


def test_a_tile_of_a_liar_takes_all_forward_photons_with_it(
    folder: DataFolder, ledger: Ledger, schedule: job_pb2.RangeSchedule
) -> None:
    render = _stored(folder, ledger, schedule)
    rows = [TileRow(0, 4, b"x", own=b"x", photons=b"x"), TileRow(1, 4, b"x", own=b"x", photons=b"x")]
    workers = {0: ["liar"], 1: ["honest"], PHOTONS: ["honest"]}
    _commit(ledger, render, [*rows, TileRow(PHOTONS, 1, b"")], workers)
    ledger.workers.quarantine("liar", "It lied.", 1.0, mismatched=True)
    assert folder.tiles.manifest(render[0]) == (0, 4, 0, 0, 0)
