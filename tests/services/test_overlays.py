"""Overlays: documents that are laid over an imported scene, and stay when it is imported again."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import compile_to
from nocturne_client.scene_files import digest, read_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

_ROOM = """mtllib room.mtl
v 0 0 0
v 4 0 0
v 4 0 3
v 0 0 3
v 1 2.8 1
v 2 2.8 1
v 2 2.8 2
v 1 2.8 2
usemtl floor
f 4 3 2 1
usemtl panel
f 5 6 7 8
"""
_OVERLAY: dict[str, Any] = {
    "base": "room/scene.json",
    "name": "with a lamp",
    "environment": None,
    "replace": {
        "kernels": {"floor": {"type": "lambertian", "reflectance": 0.2}},
        "surfaces": {"panel": {"luminaire": {"radiance": {"illuminant": "D65", "luminance": 1000}}}},
    },
    "sensor": {
        "type": "meters",
        "instruments": [{"name": "desk", "points": [[2, 0.5, 1.5]], "normal": [0, 1, 0]}],
    },
}


def _imported(folder: Path, floor: float = 0.5) -> None:
    (folder / "room.obj").write_text(_ROOM)
    (folder / "room.mtl").write_text(f"newmtl floor\nKd {floor} {floor} {floor}\nnewmtl panel\nKd 0 0 0\n")
    import_scene(folder / "room.obj", folder / "room", ImportOptions())


def _overlay(folder: Path, **changes: Any) -> Path:
    path = folder / "office.json"
    path.write_text(json.dumps(_OVERLAY | changes))
    return path


def _problems(path: Path) -> dict[str, str]:
    with pytest.raises(NocturneClientError) as raised:
        read_scene(path)
    return {each.place: each.message for each in raised.value.problems}


def test_an_imported_room_gets_its_lamp_and_its_meters(tmp_path: Path) -> None:
    _imported(tmp_path)
    scene = read_scene(_overlay(tmp_path))
    document = check_document(scene.document)
    assert document.kernels["floor"].model_dump()["reflectance"] == 0.2
    by_name = {each.name: each for each in document.surfaces}
    assert by_name["panel"].luminaire is not None
    assert by_name["floor"].luminaire is None
    assert (document.name, document.environment, document.sensor.type) == ("with a lamp", None, "meters")
    # The base's files lie in its own folder.
    assert {digest(each) for each in (tmp_path / "room").rglob("*.ply")} <= scene.files.keys()
    compile_to(tmp_path / "office.json", tmp_path / "compiled", 1, 1, 4)


def test_an_overlay_survives_the_next_import(tmp_path: Path) -> None:
    """The same overlay over a room that became longer: its changes are there, the floor is new."""
    _imported(tmp_path)
    overlay = _overlay(tmp_path)
    before = read_scene(overlay)
    shutil.rmtree(tmp_path / "room")
    moved = _ROOM.replace("v 4 ", "v 5 ")
    (tmp_path / "room.obj").write_text(moved)
    import_scene(tmp_path / "room.obj", tmp_path / "room", ImportOptions())
    after = read_scene(overlay)
    assert before.document["kernels"] == after.document["kernels"]
    (floor,) = (each for each in after.document["surfaces"] if each["name"] == "floor")
    mesh: Any = trimesh.load(after.files[floor["shape"]["asset"].removeprefix("sha256:")])
    assert np.max(mesh.vertices[:, 0]) == pytest.approx(5.0)


def test_files_of_an_overlay_lie_beside_it(tmp_path: Path) -> None:
    _imported(tmp_path)
    (tmp_path / "lamp.ies").write_text("IESNA")
    overlay = _overlay(tmp_path, surfaces=[{"name": "spot", "luminaire": {"profile": {"asset": "lamp.ies"}}}])
    scene = read_scene(overlay)
    assert scene.files[digest(tmp_path / "lamp.ies")] == tmp_path / "lamp.ies"
    assert scene.document["surfaces"][-1]["name"] == "spot"


def test_names_that_are_not_there_are_errors_that_list_those_that_are(tmp_path: Path) -> None:
    _imported(tmp_path)
    replace = {"kernels": {"flor": 0.5}, "surfaces": {"lamp": {}}, "sensor": {}}
    found = _problems(_overlay(tmp_path, replace=replace, remove={"surfaces": ["sofa"]}, lamps=[]))
    assert "no kernels named 'flor'" in found["$.replace.kernels"]
    assert "floor" in found["$.replace.kernels"]
    assert found["$.replace.surfaces"].endswith("it has floor, panel")
    assert found["$.remove.surfaces[0]"].endswith("it has floor, panel")
    assert "expected one of" in found["$.replace.sensor"]
    assert "replace" in found["$.lamps"]


def test_what_is_added_has_a_new_name(tmp_path: Path) -> None:
    _imported(tmp_path)
    found = _problems(_overlay(tmp_path, kernels={"floor": {"type": "lambertian", "reflectance": 0.1}}))
    assert "the base has 'floor' already" in found["$.kernels"]


def test_surfaces_are_removed_in_groups_too(tmp_path: Path) -> None:
    quad = {"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
    surfaces = [{"name": each, "shape": quad, "kernel": "k"} for each in ("a", "b")]
    base = {
        "nocturne": 1,
        "kernels": {"k": {"type": "lambertian", "reflectance": 0.5}},
        "groups": {"g": surfaces},
        "surfaces": surfaces,
        "instances": [{"name": "a", "group": "g"}],
    }
    (tmp_path / "base.json").write_text(json.dumps(base))
    (tmp_path / "over.json").write_text(json.dumps({"base": "base.json", "remove": {"surfaces": ["a"]}}))
    made = read_scene(tmp_path / "over.json").document
    assert [each["name"] for each in (*made["surfaces"], *made["groups"]["g"])] == ["b", "b"]
    assert len(made["instances"]) == 1


@pytest.mark.parametrize(
    ("base", "said"),
    [
        ("../room.json", "without `..`"),
        ("none.json", "no such file"),
        ("room.glb", "nocturne import room.glb"),
        ("over.json", "more than 8 overlays"),
        (3, "expected the path"),
    ],
)
def test_a_base_that_cannot_be_read_is_said(base: Any, said: str, tmp_path: Path) -> None:
    (tmp_path / "over.json").write_text(json.dumps({"base": base}))
    assert said in _problems(tmp_path / "over.json")["$.base"]
