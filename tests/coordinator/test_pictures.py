"""What becomes of pictures whose folder goes, or has no room."""

import errno
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from nocturne_coordinator.dispatch.events import Moment, PicturesMade
from nocturne_coordinator.dispatch.records import RenderCommit, TileRow, Totals
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.sign_of_life import SignOfLife
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.removal import delete_render
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule

_EDGE, _SAMPLES = 32, 4


def _running(folder: DataFolder, ledger: Ledger, number: int) -> RunningRender:
    """A render of one tile, with its first samples committed."""
    schedule = make_schedule(_EDGE, _EDGE, 64)
    row = folder.renders.create(NewRender(f"{number}", "", "5c" * 32, "{}", _EDGE, _EDGE, 64, schedule))
    taken = ledger.renders.take(row.id)
    assert taken is not None
    assert ledger.commits.start(row.id, taken.fence, time.time())
    tile = TileRow(0, _SAMPLES, bytes(_EDGE * _EDGE * 32))
    totals = Totals(1, _SAMPLES * _EDGE * _EDGE, 5, 0, 0.5)
    assert ledger.commits.commit([RenderCommit(row.id, taken.fence, [tile], totals, 10.0)]) == []
    return RunningRender(taken, ledger.renders.tiles(row.id))


def test_a_folder_that_goes_with_its_render_is_no_trouble(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    pictures = Previews(folder, ledger)
    kept, deleted = (_running(folder, ledger, number) for number in (1, 2))

    def taken_away(path: Path, *_: object) -> None:
        folder.requests.cancel(deleted.id)
        delete_render(folder, deleted.id)
        raise FileNotFoundError(path)

    monkeypatch.setattr("nocturne_coordinator.output.previews.write_preview", taken_away)
    with pytest.raises(LeaseLost):
        pictures.write_preview(deleted)

    def without_room(path: Path, *_: object) -> None:
        raise OSError(errno.ENOSPC, "no space left", path)

    monkeypatch.setattr("nocturne_coordinator.output.previews.write_preview", without_room)
    with pytest.raises(OSError, match="no space left"):
        pictures.write_preview(kept)


def test_a_picture_that_takes_long_looks_neither_like_hanging_nor_like_a_lost_lease(
    folder: DataFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the last image of a large film would be begun again and again."""
    ownership = Ownership(folder.root, folder.database, shared=True)
    ledger = Ledger(folder.database, ownership)
    render, alive = _running(folder, ledger, 1), tmp_path / "alive"
    ledger.leases.renew(time.time())
    monkeypatch.setattr("nocturne_coordinator.output.previews._BUSY_S_PER_PIXEL", 1.0)
    seconds = _EDGE * _EDGE
    left: list[float] = []

    def until() -> float:
        rows = folder.database.rows("SELECT until FROM coordinator WHERE number = ?", (ownership.number,))
        return float(rows[0]["until"])

    def meanwhile(path: Path, *_: object) -> None:
        left.extend([until() - time.time(), alive.stat().st_mtime - time.time()])
        path.write_bytes(b"")

    monkeypatch.setattr("nocturne_coordinator.output.pictures.write_image", meanwhile)
    Previews(folder, ledger, SignOfLife(alive)).write_image(render)
    assert min(left) > seconds - 60.0
    # The next sign of life ends that.
    ledger.leases.renew(time.time())
    assert until() < time.time() + 2 * ownership.lease_seconds


# --- by processes ---


def _until(true: Callable[[], bool]) -> None:
    until = time.monotonic() + 60.0
    while not true():
        assert time.monotonic() < until
        time.sleep(0.05)


@pytest.fixture
def apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """All films count as large."""
    monkeypatch.setattr("nocturne_coordinator.output.previews.APART_PIXELS", 0)


def test_a_process_writes_the_same_files(folder: DataFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    pictures, render = Previews(folder, ledger), _running(folder, ledger, 1)
    places = [folder.image_path(render.id), folder.preview_path(render.id), folder.thumbnail_path(render.id)]

    def written() -> list[bytes]:
        pictures.write_image(render)
        pictures.write_preview(render, final=True)
        pictures.write_thumbnail(render)
        return [place.read_bytes() for place in places]

    here = written()
    monkeypatch.setattr("nocturne_coordinator.output.previews.APART_PIXELS", 0)
    for place in places:
        place.unlink()
    began = time.monotonic()
    assert pictures.made(render, True, _moment) is None
    assert time.monotonic() - began < 1.0
    _until(lambda: pictures.made(render, True, _moment) is not None)
    assert not any(place.exists() for place in places)
    pictures.write_image(render)
    assert [place.read_bytes() for place in places] == here
    assert sorted(places[0].parent.iterdir()) == sorted(places)


@pytest.mark.usefixtures("apart")
def test_a_process_looks_at_a_render_that_goes_on(folder: DataFolder) -> None:
    """Its error is what the coordinator itself would find; the last pictures do not wait for such ones."""
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    pictures, render = Previews(folder, ledger), _running(folder, ledger, 1)
    found: list[PicturesMade] = []

    def is_made(final: bool) -> bool:
        found.extend(made for made in [pictures.made(render, final, _moment)] if made)
        return bool(found)

    _until(lambda: is_made(final=False))
    apart = found.pop().apart
    assert apart is not None
    point, _ = render.error_point(apart.point.unix_time)
    assert (apart.point, apart.estimate) == (point, render.estimate)
    assert folder.preview_path(render.id).exists()
    assert folder.thumbnail_path(render.id).exists()
    assert not folder.image_path(render.id).exists()
    assert not is_made(final=False)
    assert not is_made(final=True)
    (running,) = pictures._processes._running.values()
    assert running.final
    _until(lambda: is_made(final=True))


def _moment() -> Moment:
    return Moment(0.0, 0.0)


def test_one_whose_pictures_fail_keeps_nobody_elses(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor is it tried again at each look."""
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    pictures = Previews(folder, ledger)
    bad, good = (_running(folder, ledger, number) for number in (1, 2))
    tries: list[str] = []
    write = Previews.write_image

    def fails(self: Previews, render: RunningRender) -> None:
        tries.append(render.id)
        if render.id == bad.id:
            raise OSError(errno.ENOSPC, "no space left")
        write(self, render)

    monkeypatch.setattr(Previews, "write_image", fails)
    for render in (bad, good):
        folder.requests.cancel(render.id)
    for _ in range(5):
        pictures.finish_ended(time.time())
    assert [folder.renders.get(each.id).image_final for each in (bad, good)] == [False, True]
    assert tries == [bad.id, good.id]


@pytest.mark.usefixtures("apart")
def test_a_process_that_fails_is_tried_again_and_others_go_on(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where memory is short: of one owner one at a time, and of others beside."""
    monkeypatch.setattr("nocturne_coordinator.output.pictures._SHORTEST_PAUSE", 0.1)
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    pictures = Previews(folder, ledger)
    renders = [_running(folder, ledger, number) for number in (1, 2, 3)]
    folder.database.execute("UPDATE render SET owner = 'bob' WHERE id = ?", (renders[2].id,))
    for render in renders:
        folder.requests.cancel(render.id)
    pictures.finish_ended(time.time())
    running = pictures._processes._running
    assert {owner: each.render_id for owner, each in running.items()} == {
        "": renders[0].id,
        "bob": renders[2].id,
    }
    running[""].process.kill()

    def are_final() -> bool:
        pictures.finish_ended(time.time())
        return all(folder.renders.get(render.id).image_final for render in renders)

    _until(are_final)
    assert all(folder.image_path(render.id).exists() for render in renders)
    assert not running
