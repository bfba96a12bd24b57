"""Scenes in ZIP archives: imported as from a folder, and nothing is written outside of it or without
bounds."""

import io
import json
import stat
import zipfile
from pathlib import Path

import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats import archives
from nocturne_scene.formats.import_scene import FORMATS, import_scene
from nocturne_scene.formats.reading.options import ImportOptions

from tests.scene.formats.test_gltf import tree


def archive(folder: Path, members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> Path:
    file = folder / "scene.zip"
    with zipfile.ZipFile(file, "w", compression) as opened:
        for name, content in members.items():
            opened.writestr(name, content)
    return file


def test_a_scene_in_an_archive_is_imported(tmp_path: Path) -> None:
    text = json.dumps(tree()).encode()
    file = archive(tmp_path, {"room/old/a.gltf": b"{}", "room/b.gltf": text, "room/notes.txt": b""})
    found = import_scene(file, tmp_path / "out", ImportOptions())
    assert json.loads(found.document.read_text())["name"] == "b"


def among(folder: Path, files: dict[str, str]) -> str:
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    return archives.scene_among(files, FORMATS, "$", folder)


def test_the_scene_is_the_file_nearest_to_the_top(tmp_path: Path) -> None:
    names = ["x/a.xml", "x/scene.xml", "x/y/z.gltf", "readme.md"]
    assert among(tmp_path, dict.fromkeys(names, "")) == "x/scene.xml"
    with pytest.raises(InputError, match="holds no scene"):
        among(tmp_path, {"readme.md": ""})


def test_of_several_scenes_it_is_the_one_that_names_the_others(tmp_path: Path) -> None:
    files = {"floor.pbrt": "", "lamps.pbrt": "", "room.pbrt": 'Include "floor.pbrt" Include "lamps.pbrt"'}
    assert among(tmp_path, files) == "room.pbrt"


def test_meshes_of_a_scene_are_no_scenes(tmp_path: Path) -> None:
    assert among(tmp_path, {"room/scene.xml": "", "mesh.obj": "", "room/scene.obj": ""}) == "room/scene.xml"
    assert among(tmp_path, {"model/house.obj": "", "model/house.mtl": ""}) == "model/house.obj"


@pytest.mark.parametrize("names", [["a.xml", "b.xml"], ["x/b.pbrt", "x/a.gltf"], ["scene.xml", "scene.glb"]])
def test_several_scenes_are_not_taken_by_the_alphabet(tmp_path: Path, names: list[str]) -> None:
    with pytest.raises(InputError, match=f"several scenes, {', '.join(sorted(names))}; give one of them"):
        among(tmp_path, dict.fromkeys(names, ""))


@pytest.mark.parametrize("name", ["../a.xml", "/etc/a.xml", "x/../../a.xml", "x\\..\\a.xml"])
def test_nothing_is_written_outside(tmp_path: Path, name: str) -> None:
    (tmp_path / "in").mkdir()
    with pytest.raises(InputError, match="no path below"):
        archives.unpack(archive(tmp_path, {name: b"<scene/>"}), tmp_path / "in")
    assert not list((tmp_path / "in").iterdir())


def test_a_member_without_a_name_is_told(tmp_path: Path) -> None:
    """A name ends at a byte of 0."""
    file = archive(tmp_path, {"?a.xml": b"<scene/>"})
    file.write_bytes(file.read_bytes().replace(b"?a.xml", b"\0a.xml"))
    (tmp_path / "in").mkdir()
    with pytest.raises(InputError, match="no path below"):
        archives.unpack(file, tmp_path / "in")


def test_names_that_are_no_text_are_told(tmp_path: Path) -> None:
    """As the flag of a member says that its name is UTF-8."""
    file = archive(tmp_path, {"\N{SNOWMAN}.xml": b"<scene/>"})
    file.write_bytes(file.read_bytes().replace("\N{SNOWMAN}".encode(), b"\x96\x96\x96"))
    (tmp_path / "in").mkdir()
    with pytest.raises(InputError, match="no text"):
        archives.unpack(file, tmp_path / "in")


def test_links_are_refused(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("a.xml")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    file = tmp_path / "scene.zip"
    with zipfile.ZipFile(file, "w") as opened:
        opened.writestr(link, "/etc/passwd")
    with pytest.raises(InputError, match="is a link"):
        archives.unpack(file, tmp_path / "in")


def test_what_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = archive(tmp_path, {"a.xml": bytes(3_000_000)})
    assert file.stat().st_size < 10_000
    monkeypatch.setattr(archives, "MAX_BYTES", 2_000_000)
    with pytest.raises(InputError, match="more than 2000000 bytes"):
        archives.unpack(file, tmp_path / "in")
    monkeypatch.setattr(archives, "MAX_FILES", 1)
    with pytest.raises(InputError, match="2 files"):
        archives.unpack(archive(tmp_path, {"a": b"", "b": b""}), tmp_path / "in")


def test_broken_archives_are_refused(tmp_path: Path) -> None:
    whole = archive(tmp_path, {f"{i}.xml": bytes(range(200)) * 20 for i in range(3)}).read_bytes()
    for cut in range(0, len(whole), 37):
        for broken in (whole[:cut], whole[:cut] + b"\xff" + whole[cut + 1 :]):
            (tmp_path / "broken.zip").write_bytes(broken)
            folder = tmp_path / f"in-{cut}-{len(broken)}"
            try:
                archives.unpack(tmp_path / "broken.zip", folder)
            except InputError:
                continue
    assert zipfile.is_zipfile(io.BytesIO(whole))
