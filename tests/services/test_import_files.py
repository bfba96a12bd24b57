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


def test_links_out_of_the_folder_are_not_followed(tmp_path: Path) -> None:
    written(
        tmp_path, {"room/a.xml": b'"link" "id_rsa.png" "b.png"', "id_rsa": b"secret", "secret/b.png": b""}
    )
    (tmp_path / "room" / "link").symlink_to(tmp_path / "id_rsa")
    (tmp_path / "room" / "parts").symlink_to(tmp_path / "secret")
    assert list(files_of_import(tmp_path / "room" / "a.xml")) == ["a.xml"]


def test_links_within_the_folder_are_files_of_it(tmp_path: Path) -> None:
    """https://github.com/aws-deadline/deadline-cloud-for-cinema-4d/issues/383: pictures by a link."""
    content = b'"inner.png" "tex/deep.png"'
    written(tmp_path, {"a.pbrt": content, "real.png": b"p", "textures/deep.png": b"q"} | OTHERS)
    (tmp_path / "inner.png").symlink_to("real.png")
    (tmp_path / "tex").symlink_to("textures")
    (tmp_path / "textures" / "up").symlink_to(tmp_path)
    (tmp_path / "broken.png").symlink_to("nowhere.png")
    found = files_of_import(tmp_path / "a.pbrt")
    assert list(found) == ["a.pbrt", "inner.png", "tex/deep.png", "textures/deep.png"]
    assert found["inner.png"][1].read_bytes() == b"p"


def test_names_in_capitals(tmp_path: Path) -> None:
    """As Windows finds them."""
    written(tmp_path, {"a.pbrt": b'"Textures\\Wood.PNG"', "textures/wood.png": b"p"} | OTHERS)
    assert list(files_of_import(tmp_path / "a.pbrt")) == ["a.pbrt", "textures/wood.png"]


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_names_in_text_of_other_systems(encoding: str, tmp_path: Path) -> None:
    written(tmp_path, {"a.pbrt": '"string filename" "Möbel.png"'.encode(encoding), "Möbel.png": b"p"})
    assert list(files_of_import(tmp_path / "a.pbrt")) == ["Möbel.png", "a.pbrt"]


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
