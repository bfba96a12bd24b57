"""Of a folder only what a scene names leaves the machine."""

import gzip
from pathlib import Path

import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.import_files import files_of_import

OTHERS = {"id_rsa": b"secret", "notes/diary.txt": b"secret", "other.png": b"x", "unused.xml": b"'id_rsa'"}


def written(folder: Path, files: dict[str, bytes]) -> Path:
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


ROOMS: dict[str, dict[str, bytes]] = {
    "room.xml": {
        "room.xml": b"<!-- don't --> <include filename='parts/floor.xml'/> <!-- can't -->",
        "parts/floor.xml": b'<x y="wood &amp; oak.png"/> <!-- don\'t --> <x y="a.ply"/> <!-- \' -->',
        "textures/wood & oak.png": b"p",
        "parts/a.ply": b"p",
    },
    "room.pbrt": {
        "room.pbrt": b'Include "floor.pbrt.gz"',
        "floor.pbrt.gz": gzip.compress(b'Shape "plymesh" "string filename" "a\\b.ply"'),
        "deep/b.ply": b"p",
    },
    "room.gltf": {"room.gltf": b'{"uri": "bin%20data/all%2B1.bin"}', "bin data/all+1.bin": b""},
}


@pytest.mark.parametrize("scene", ROOMS)
def test_what_a_scene_names_is_sent(scene: str, tmp_path: Path) -> None:
    written(tmp_path, ROOMS[scene] | OTHERS)
    found = files_of_import(tmp_path / scene)
    assert list(found) == sorted(ROOMS[scene])
    assert all(file == tmp_path / name for name, (_, file) in found.items())


def test_an_archive_is_sent_alone(tmp_path: Path) -> None:
    written(tmp_path, {"a.zip": b'"id_rsa"'} | OTHERS)
    assert list(files_of_import(tmp_path / "a.zip")) == ["a.zip"]


def test_links_are_not_followed(tmp_path: Path) -> None:
    written(tmp_path, {"a.xml": b'"link" "id_rsa.png"', "id_rsa": b"secret"})
    (tmp_path / "link").symlink_to(tmp_path / "id_rsa")
    assert list(files_of_import(tmp_path / "a.xml")) == ["a.xml"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "no such file"),
        (b"no gzip", "Not a gzipped file"),
        (gzip.compress(b"x", mtime=0)[:-9], "end-of-stream"),
    ],
)
def test_what_cannot_be_read_is_told(content: bytes | None, said: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "a.pbrt.gz").write_bytes(content)
    with pytest.raises(NocturneClientError, match=r"a\.pbrt\.gz: ") as caught:
        files_of_import(tmp_path / "a.pbrt.gz")
    assert said in str(caught.value)


def test_a_folder_without_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, {"a.xml": b""} | OTHERS)
    monkeypatch.setattr("nocturne_client.import_files._MAX_LOOKED_AT", 3)
    with pytest.raises(NocturneClientError, match="a folder of their own"):
        files_of_import(tmp_path / "a.xml")
