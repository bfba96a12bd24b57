"""The data folder: one truth for several processes."""

import hashlib
import sqlite3
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
from nocturne_coordinator import errors
from nocturne_coordinator.dispatch.records import RenderCommit, TileRow, Totals
from nocturne_coordinator.errors import Conflict, OwnershipLost, UnusableFolder
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.ranges import make_schedule


@pytest.fixture
def folder(tmp_path: Path) -> DataFolder:
    return DataFolder(tmp_path / "data")


def new_render(request_id: str = "a") -> NewRender:
    return NewRender(request_id, "name", "5c" * 32, '{"nocturne": 1}', 40, 33, 20, make_schedule(40, 33, 20))


def test_a_request_makes_one_render(folder: DataFolder) -> None:
    render = folder.renders.create(new_render())
    assert folder.renders.create(new_render()) == render
    assert render.state == "QUEUED"
    assert (render.ranges_planned, render.sequence) == (4 * 4, 1)
    with pytest.raises(Conflict):
        folder.renders.create(replace(new_render(), samples=21))
    assert len(folder.renders.page(0, "")[0]) == 1


@pytest.mark.parametrize("request_id", ["", "x" * 129])
def test_a_bad_request_id_leaves_nothing(folder: DataFolder, request_id: str) -> None:
    with pytest.raises(InputError, match=r"\$\.request_id"):
        folder.renders.create(new_render(request_id))
    assert folder.renders.page(0, "") == ([], "")


def test_pages_are_newest_first_and_complete(folder: DataFolder) -> None:
    made = [folder.renders.create(new_render(str(number))).id for number in range(7)]
    seen: list[str] = []
    token = ""
    for _ in range(3):
        page, token = folder.renders.page(3, token)
        seen += [row.id for row in page]
    assert (seen, token) == (made[::-1], "")


@pytest.mark.parametrize("token", ["?", "AAAA", "AAAAAAAAAAA=", "_" * 400, "é"])
def test_a_page_token_of_ones_own_is_refused(folder: DataFolder, token: str) -> None:
    with pytest.raises(InputError, match="page_token"):
        folder.renders.page(3, token)


def test_what_is_not_there_is_not_found(folder: DataFolder) -> None:
    for ask in (folder.renders.get, folder.requests.cancel, folder.image_path, folder.renders.error_history):
        with pytest.raises(NotFound):
            ask("../etc")


def test_other_processes_changes_are_seen(folder: DataFolder) -> None:
    other = DataFolder(folder.root)
    before = folder.change_counter()
    assert folder.change_counter() == before
    render = other.renders.create(new_render())
    after = folder.change_counter()
    assert after > before
    folder.requests.cancel(render.id)
    assert folder.change_counter() > after
    other.close()


def test_cancel_is_final_and_seen_once(folder: DataFolder) -> None:
    render = folder.renders.create(new_render())
    cancelled = folder.requests.cancel(render.id)
    assert cancelled.state == "CANCELLED"
    assert cancelled.sequence == render.sequence + 1
    assert folder.requests.cancel(render.id) == cancelled


def commit_of(render_id: str, samples: int, fence: int = 1) -> RenderCommit:
    tile = TileRow(0, samples, bytes(32 * 32 * 32))
    return RenderCommit(render_id, fence, [tile], Totals(1, samples * 1024, 5, 0, 0.5), 10.0)


def take(ledger: Ledger, render_id: str) -> int:
    """Takes and starts a render; its fence."""
    row = ledger.renders.take(render_id)
    assert row is not None
    ledger.commits.start(render_id, row.fence, 1.0)
    return row.fence


def test_a_commit_to_an_ended_render_is_dropped(folder: DataFolder) -> None:
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    render = folder.renders.create(new_render())
    assert take(ledger, render.id) == 1
    assert ledger.commits.commit([commit_of(render.id, 4)]) == []
    folder.requests.cancel(render.id)
    ledger.commits.commit([commit_of(render.id, 8)])
    assert [tile.samples for tile in ledger.renders.tiles(render.id)] == [4]
    assert folder.renders.get(render.id).photons == 4 * 1024
    assert [row.id for row in ledger.renders.ended_without_image()] == [render.id]


def test_a_replaced_owner_can_not_commit(folder: DataFolder) -> None:
    ownership = Ownership(folder.root, folder.database)
    ledger = Ledger(folder.database, ownership)
    render = folder.renders.create(new_render())
    take(ledger, render.id)
    ownership.release()
    Ownership(folder.root, folder.database)
    with pytest.raises(OwnershipLost):
        ledger.commits.commit([commit_of(render.id, 4)])
    assert folder.renders.get(render.id).photons == 0


def test_a_folder_of_another_version_is_refused(folder: DataFolder) -> None:
    folder.close()
    with sqlite3.connect(folder.root / "nocturne.db") as connection:
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(UnusableFolder, match="99"):
        DataFolder(folder.root)


def test_a_blob_is_whole_or_not_there(tmp_path: Path) -> None:
    blobs = BlobStore(tmp_path)
    sha256 = hashlib.sha256(b"data").hexdigest()
    for declared, written in ((4, b"dat"), (4, b"dada"), (3, b"data"), (2**40, b"data")):
        with pytest.raises(InputError), blobs.writer(sha256, declared) as writer:
            writer.write(written)
    with pytest.raises(RuntimeError), blobs.writer(sha256, 4) as writer:
        raise RuntimeError
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    assert blobs.missing([sha256, sha256]) == [sha256]
    assert blobs.put(b"data") == sha256
    assert (blobs.path(sha256).read_bytes(), blobs.size(sha256), blobs.missing([sha256])) == (b"data", 4, [])


@pytest.mark.parametrize("sha256", ["", "../" + "a" * 61, "A" * 64, "a" * 64 + "\n"])
def test_a_digest_is_never_a_path(tmp_path: Path, sha256: str) -> None:
    with pytest.raises(InputError):
        BlobStore(tmp_path).path(sha256)


def test_a_full_disk_of_temporary_files_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """SQLite says only that "database or disk is full"."""
    temporary, trouble = tmp_path / "tmp", sqlite3.OperationalError("database or disk is full")
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    monkeypatch.setattr(errors, "_free", lambda folder: 0 if folder == temporary else 2**30)
    assert str(UnusableFolder.because(tmp_path, trouble)).startswith(f"{temporary} is full, where ")
    monkeypatch.setattr(errors, "_free", lambda _: 2**30)
    assert str(UnusableFolder.because(tmp_path, trouble)).startswith(f"{tmp_path} can't be used (database ")
