"""Files that mean harm: clear errors in bounded time, and nothing outside of the scene's folder is read."""

import gzip
import time
from pathlib import Path

import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.mitsuba.read import tree
from nocturne_scene.formats.reading.options import ImportOptions

BOMB = """<?xml version="1.0"?><!DOCTYPE scene [<!ENTITY a "aaaaaaaaaa">
<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]>
<scene version="3.0.0"><default name="x" value="&c;"/></scene>"""
OUTSIDE = '<!DOCTYPE scene [<!ENTITY x SYSTEM "file:///etc/passwd">]><scene version="3.0.0">&x;</scene>'
CAMERA = '<sensor type="perspective"><float name="fov" value="40"/></sensor><emitter type="constant"/>'
SERIALIZED = '<shape type="serialized"><string name="filename" value="b.serialized"/></shape>'
PBRT = 'Camera "perspective"\nWorldBegin\n'


def refuse(tmp_path: Path, name: str, content: str | bytes, said: str) -> None:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    started = time.process_time()
    with pytest.raises(InputError, match=said):
        import_scene(folder / name, tmp_path / "out", ImportOptions(allow_missing=True))
    assert time.process_time() - started < 20
    assert not (tmp_path / "out").exists()
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".import")] == []


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (BOMB, "document type"),
        (OUTSIDE, "document type"),
        ("<scene" + " " * 100, "no XML"),
        ("", "no XML"),
        (b'<?xml version="1.0" encoding="utf-99"?><scene/>', "encoding|no XML"),
        (b'<?xml version="1.0" encoding="utf-8"?><scene x="\xff\xfe"/>', "no sensor"),
        ('<scene version="3.0.0">' + "<shape>" * 100 + "</shape>" * 100 + "</scene>", "nested more than 64"),
        ('<scene version="3.0.0"><include filename="a.xml"/></scene>', "includes itself"),
        ('<scene version="old"></scene>', "expected a version"),
        ('<scene version="3.0.0"><include filename="../b.xml"/></scene>', "leads out of"),
        ('<scene version="3.0.0"><include filename="/etc/passwd"/></scene>', "absolute path"),
        ('<scene version="3.0.0"><include filename="C:\\\\a.xml"/></scene>', "absolute path"),
        ('<scene version="3.0.0"><path value="../.."/></scene>', "leads out of"),
        ('<scene version="3.0.0"><include filename="link.xml"/></scene>', "leads out of"),
        (
            f'<scene version="3.0.0">{CAMERA}<shape type="sphere">'
            '<float name="radius" value="1e400"/></shape></scene>',
            "finite",
        ),
    ],
)
def test_xml(tmp_path: Path, content: str | bytes, said: str) -> None:
    (tmp_path / "b.xml").write_text("<scene/>")
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "link.xml").symlink_to(tmp_path / "b.xml")
    refuse(tmp_path, "a.xml", content, said)


def test_files_that_include_each_other_many_times(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two includes in each of 15 files: 2^15 times the last one, with 100 elements each."""
    monkeypatch.setattr(tree, "_MAX_ELEMENTS", 10_000)
    folder = tmp_path / "in"
    folder.mkdir()
    for number in range(1, 15):
        twice = f'<include filename="{number + 1}.xml"/>' * 2
        (folder / f"{number}.xml").write_text(f'<scene version="3.0.0">{twice}</scene>')
    (folder / "15.xml").write_text('<scene version="3.0.0">' + "<shape/>" * 100 + "</scene>")
    refuse(tmp_path, "a.xml", '<scene version="3.0.0"><include filename="1.xml"/></scene>', "more than")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no serialized mesh"),
        (b"\x1c\x04\x04\x00" + b"x" * 40, "damaged|decompressed"),
        (b"\x1c\x04\x04\x00x\x9c" + b"\x00" * 30 + b"\x00" * 8 + b"\x01\x00\x00\x00", "decompressed"),
        (b"\xff" * 64, "damaged|no serialized"),
    ],
)
def test_serialized_meshes(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "b.serialized").write_bytes(content)
    refuse(tmp_path, "a.xml", f'<scene version="3.0.0">{CAMERA}{SERIALIZED}</scene>', said)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.pbrt", PBRT + 'Include "a.pbrt"', "includes itself"),
        ("a.pbrt", PBRT + 'Include "../b.pbrt"', "leads out of"),
        ("a.pbrt", PBRT + 'Shape "plymesh" "string filename" "/etc/passwd"', "absolute path"),
        ("a.pbrt", PBRT + "AttributeBegin\n" * 100, "nested more than 64"),
        ("a.pbrt", PBRT + 'Shape "sphere" "float radius" [1', "ends in the middle"),
        ("a.pbrt", b"\xff\xfe\x00", "no text"),
        ("a.pbrt", PBRT + "]" * 10, "no directive"),
        ("a.pbrt", PBRT + 'Shape "sphere', "unexpected"),
        ("a.pbrt.gz", b"no gzip", "can't be decompressed"),
        ("a.pbrt.gz", gzip.compress(b"#" * 4_000_000) * 100, "once decompressed"),
        ("a.gltf", "[" * 100_000, "no JSON"),
        ("a.gltf", '{"asset": {"version": "2.0"}, "scenes": 5}', "scenes: expected an array"),
        ("a.glb", b"glTF" + b"\xff" * 40, "no GLB"),
        ("a.txt", "hello", "ends in"),
    ],
)
def test_other_formats(tmp_path: Path, name: str, content: str | bytes, said: str) -> None:
    (tmp_path / "b.pbrt").write_text("")
    refuse(tmp_path, name, content, said)


def test_the_target_is_never_written_over(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(f'<scene version="3.0.0">{CAMERA}<shape type="sphere"/></scene>')
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine").write_text("mine")
    with pytest.raises(InputError, match="not an empty folder"):
        import_scene(tmp_path / "a.xml", tmp_path / "out", ImportOptions())
    assert (tmp_path / "out" / "mine").read_text() == "mine"
