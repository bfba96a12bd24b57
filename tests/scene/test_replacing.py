"""Write, then rename: who reads a file meets the old one or the new one."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.replacing import UNFINISHED, replacing


@pytest.mark.parametrize("durable", [False, True])
def test_a_file_is_replaced_when_it_is_whole(tmp_path: Path, durable: bool) -> None:
    path = tmp_path / "a.json"
    path.write_text("old")
    with replacing(path, durable=durable) as unfinished:
        unfinished.write_text("new")
        assert path.read_text() == "old"
        assert (unfinished.parent, unfinished.suffix) == (tmp_path, ".json")
        assert unfinished.name.startswith(UNFINISHED)
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as unfinished:
        unfinished.write_text("half" * (1 // unfinished.stat().st_size))
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_of_its_own_keeps_unfinished_files_apart(tmp_path: Path) -> None:
    incoming = tmp_path / "incoming"
    incoming.mkdir()
    with replacing(tmp_path / "a", folder=incoming) as unfinished:
        assert [path.name for path in tmp_path.iterdir()] == ["incoming"]
        assert list(incoming.iterdir()) == [unfinished]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "incoming"]


def test_what_guards_the_renaming_may_refuse_it(tmp_path: Path) -> None:
    path = tmp_path / "a"

    @contextmanager
    def refusing() -> Iterator[None]:
        raise PermissionError
        yield

    with pytest.raises(PermissionError), replacing(path, within=refusing()) as unfinished:
        unfinished.write_text("whole")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("durable", [False, True])
def test_only_a_durable_store_waits_for_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, durable: bool
) -> None:
    waited: list[int] = []
    monkeypatch.setattr(os, "fsync", waited.append)
    blobs = BlobStore(tmp_path, durable=durable)
    assert blobs.is_whole(blobs.put(b"light"))
    assert bool(waited) == durable


@pytest.mark.parametrize("umask", [0o022, 0o077])
def test_a_file_has_the_rights_that_the_umask_gives(tmp_path: Path, umask: int) -> None:
    before = os.umask(umask)
    try:
        with replacing(tmp_path / "a"):
            pass
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o666 & ~umask
