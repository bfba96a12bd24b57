"""After the loss of Redis, the database or the whole machine: the image is that of a run without it."""

import shutil
import signal
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from nocturne_coordinator.errors import AlreadyOwned, RestoreFailed
from nocturne_coordinator.main import EXIT_UNUSABLE
from nocturne_coordinator.store.checkpoint import Checkpoint, Checkpointer, checkpoints
from nocturne_coordinator.store.restoring import damage_of, restore
from nocturne_scene.blobs import BlobStore

from tests.coordinator.service import (
    SCENE,
    RedisServer,
    Service,
    check_committed,
    check_complete,
    committed_samples,
    wait_until,
)
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.pictures import samples_of
from tests.system.waiting import LIMIT_S

OFTEN = ("--checkpoint-seconds", "0.1")
SOME_DELAY = 0.05
"""Seconds per job."""


def half_way(service: Service, options: tuple[str, ...] = OFTEN) -> str:
    """A render in the middle of its work; its id."""
    service.start("", *options)
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done >= service.row(render.id).ranges_planned // 3)
    return render.id


def test_redis_and_all_that_it_had_on_disk_are_lost(tmp_path: Path) -> None:
    """One that writes everything down, so that there is something to lose."""
    kept = tmp_path / "redis"
    kept.mkdir()
    options = ("--appendonly", "yes", "--appendfsync", "always", "--dir", str(kept))
    server = RedisServer(tmp_path, *options)
    server.start()
    service = Service(tmp_path / "data", server)
    try:
        render = half_way(service)
        service.stop(signal.SIGKILL)
        server.kill()
        assert any(kept.rglob("*.aof"))
        shutil.rmtree(kept)
        found = restore(service.data)
        assert (found.damage, found.database, found.renders) == ([], None, 1)
        row = service.row(render)
        assert found.open_ranges == row.ranges_planned - row.ranges_done > 0
        kept.mkdir()
        server.start()
        service.start("", *OFTEN)
        check_complete(service, render)
    finally:
        service.close()
        server.kill()


def test_a_lost_machine_is_replaced_by_a_checkpoint_elsewhere(tmp_path: Path) -> None:
    """Redis, coordinator and data folder are gone for good; another folder and another Redis take over."""
    safe = tmp_path / "safe"
    places = [tmp_path / name for name in ("first", "second")]
    for place in places:
        place.mkdir()
    lost = Service(places[0] / "data", _started(places[0]))
    scene = lost.folder.blobs.put(b"a scene")
    render = half_way(lost, (*OFTEN, "--checkpoints", str(safe)))
    # It must not end while a checkpoint is made, however busy the machine is.
    lost.stop_workers()
    wait_until(lambda: bool(checkpoints(safe)) and any(samples_of(checkpoints(safe)[0].renders[render])))
    lost.close()
    lost.server.kill()
    shutil.rmtree(places[0])

    found = restore(places[1] / "data", safe)
    assert found.database is not None
    assert found.missing == [f"{render} (sha256:{SCENE})"], "the test's scene is in no folder"
    assert 0 < found.open_ranges < 6 * 27
    assert BlobStore(places[1] / "data" / "blobs").is_whole(scene)
    saved = Service(places[1] / "data", _started(places[1]))
    try:
        assert any(committed_samples(saved.folder, render).values())
        saved.start()
        saved.work(SimulatedWorker(saved.server.url))
        check_complete(saved, render)
    finally:
        saved.close()
        saved.server.kill()


def _started(place: Path) -> RedisServer:
    server = RedisServer(place)
    server.start()
    return server


def test_a_deleted_database_is_not_silently_made_anew(service: Service) -> None:
    render = half_way(service)
    wait_until(lambda: bool(checkpoints(service.data / "checkpoints")))
    service.stop()
    service.folder.close()
    for path in service.data.glob("nocturne.db*"):
        path.unlink()
    assert service.start().wait(LIMIT_S) == EXIT_UNUSABLE
    assert restore(service.data).database is not None
    service.reopen()
    service.start()
    check_complete(service, render)


def test_images_are_written_again_from_the_sums(service: Service) -> None:
    service.start("", *OFTEN)
    render = service.create(samples=20)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)
    image = service.folder.image_path(render.id).read_bytes()
    service.stop()
    Checkpointer(service.data, service.data / "checkpoints").make()
    service.folder.close()
    (service.data / "nocturne.db").unlink()
    shutil.rmtree(service.data / "images")
    restore(service.data)
    service.reopen()
    service.start()
    check_complete(service, render.id)
    assert service.folder.image_path(render.id).read_bytes() == image


def test_what_is_whole_is_never_replaced(service: Service, tmp_path: Path) -> None:
    render = half_way(service, ("--checkpoint-seconds", "0"))
    with pytest.raises(AlreadyOwned, match="stop the service"):
        restore(service.data)
    service.stop()
    assert not (service.data / "checkpoints").exists()
    elsewhere = tmp_path / "safe"
    Checkpointer(service.data, elsewhere).make()
    with pytest.raises(RestoreFailed, match="is whole"):
        restore(service.data, elsewhere)
    with pytest.raises(RestoreFailed, match="there is no folder"):
        restore(service.data, tmp_path / "nowhere")
    with pytest.raises(RestoreFailed, match="no whole checkpoint"):
        restore(tmp_path / "empty", service.data / "images")
    check_committed_now(service, render)


def check_committed_now(service: Service, render: str) -> None:
    """By the sums alone: the image is that of a moment before."""
    service.folder.requests.cancel(render)
    service.start()
    check_committed(service, service.wait_for_end(render))


def test_a_checkpoint_is_made_only_of_something_new(service: Service) -> None:
    checkpointer = Checkpointer(service.data, service.data / "checkpoints")
    assert checkpointer.make() is not None
    assert checkpointer.make() is None
    service.create()
    made = checkpointer.make()
    assert made is not None
    assert made.number == 2
    assert [each.number for each in checkpoints(service.data / "checkpoints")] == [2, 1]


@pytest.mark.parametrize(
    "statement",
    [
        "INSERT INTO webhook (id, owner, url, secret, created) VALUES ('w', '', '', '', 1.0)",
        "INSERT INTO machine VALUES ('node', x'00', 1.0, 'pool')",
        "INSERT INTO drain VALUES ('w', '', 1.0)",
        "INSERT INTO upload VALUES ('', 'ab', 1)",
        "INSERT INTO deleted_usage VALUES ('', 1, 1.0)",
        "INSERT INTO measured_region SELECT id, '[]' FROM render",
        "INSERT INTO call VALUES (NULL, 1.0, '', '', '', '', '')",
    ],
)
def test_all_that_is_worth_keeping_makes_a_checkpoint(service: Service, statement: str) -> None:
    service.create()
    checkpointer = Checkpointer(service.data, service.data / "checkpoints")
    assert checkpointer.make() is not None
    assert checkpointer.make() is None
    with closing(sqlite3.connect(service.data / "nocturne.db", isolation_level=None)) as database:
        database.execute(statement)
    assert checkpointer.make() is not None


def test_of_two_checkpointers_one_works_at_a_time(service: Service, monkeypatch: pytest.MonkeyPatch) -> None:
    """As two coordinators with --shared have them: each took the other's number, and deleted its file."""
    place = service.data / "checkpoints"
    one, other = (Checkpointer(service.data, place) for _ in range(2))
    between: list[object] = []
    copy = one._copy

    def copying(source: sqlite3.Connection) -> Checkpoint:
        between.append(other.make())
        return copy(source)

    monkeypatch.setattr(one, "_copy", copying)
    assert one.make() is not None
    assert between == [None]
    assert all(each.is_whole(place) for each in checkpoints(place))
    # It is its turn now.
    made = other.make()
    assert made is not None
    assert made.number == 2


@pytest.mark.parametrize(
    ("statement", "said"),
    [
        ("UPDATE tile SET samples = 5 WHERE tile_index = 1", "5 samples are not the end of a planned range"),
        ("UPDATE tile SET sums = zeroblob(8) WHERE tile_index = 1", "8 bytes are no sums of"),
        ("UPDATE tile SET sums = unhex_ff(length(sums)) WHERE tile_index = 1", "not finite"),
        ("UPDATE tile SET tile_index = 99 WHERE tile_index = 1", "tile 99 of 6"),
        ("UPDATE render SET schedule = x'ffff'", "render r-"),
    ],
)
def test_damage_that_sqlite_can_not_see_is_found(service: Service, statement: str, said: str) -> None:
    service.start()
    render = service.create(samples=20)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)
    service.stop()
    database = service.data / "nocturne.db"
    assert damage_of(database) == []
    with closing(sqlite3.connect(database)) as connection:
        connection.create_function("unhex_ff", 1, lambda length: b"\xff" * length)
        connection.execute(statement)
        connection.commit()
    found = damage_of(database)
    assert len(found) == 1
    assert said in found[0]
