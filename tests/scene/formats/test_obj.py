"""Wavefront OBJ files become documents."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from nocturne_client.import_files import files_of_import
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.reading.options import ImportOptions

_BOX = """mtllib room.mtl
v 0 0 0
v 2 0 0
v 2 0 3
v 0 0 3
v 0 2.5 0
v 2 2.5 0
usemtl floor
f 4/1/1 3/2/1 2 1
usemtl wall
f 1 2 -1 -2
"""
_MTL = """newmtl floor
Kd 0.2 0.2 0.2
newmtl wall
Kd 0.6 0.5 0.4
Ks 0.04 0.04 0.04
Ns 48
"""


def _imported(
    folder: Path, obj: str = _BOX, mtl: str = _MTL, *, allow_missing: bool = False
) -> tuple[dict[str, Any], Any]:
    (folder / "room.obj").write_text(obj)
    (folder / "room.mtl").write_text(mtl)
    found = import_scene(folder / "room.obj", folder / "made", ImportOptions(allow_missing=allow_missing))
    return json.loads(found.document.read_text()), found


def test_faces_go_by_their_materials(tmp_path: Path) -> None:
    document, found = _imported(tmp_path)
    floor, wall = document["surfaces"]
    assert (floor["kernel"], wall["kernel"]) == ("floor", "wall")
    assert document["kernels"]["floor"] == {"type": "lambertian", "reflectance": 0.2}
    mesh: Any = trimesh.load(found.document.parent / floor["shape"]["asset"])
    assert mesh.area == pytest.approx(6.0)
    assert mesh.face_normals == pytest.approx(np.tile([0.0, 1.0, 0.0], (2, 1)))
    mesh = trimesh.load(found.document.parent / wall["shape"]["asset"])
    assert mesh.area == pytest.approx(5.0)
    assert mesh.face_normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (2, 1)))
    shiny = document["kernels"]["wall"]
    assert shiny["specular_colour"] == 0.04
    # Walter 2007: alpha is the root of 2 / (n + 2).
    assert shiny["roughness"] ** 2 == pytest.approx(0.2)
    assert document["sensor"]["position"] == [1.0, 1.25, 1.5]


def test_light_and_what_is_clear(tmp_path: Path) -> None:
    mtl = "newmtl floor\nKd 0.5\nKe 3 3 3\nnewmtl wall\nd 0.25\n"
    document, found = _imported(tmp_path, mtl=mtl)
    assert document["surfaces"][0]["luminaire"]["radiance"]["luminance"] == pytest.approx(3.0)
    assert document["kernels"]["wall"]["opacity"] == 0.25
    assert any("75% of the light passes" in note for note in found.notes)


@pytest.mark.parametrize(
    ("obj", "mtl", "said"),
    [
        (_BOX + "l 1 2\n", _MTL, "room.obj, line 12: lines have no surface"),
        (_BOX, _MTL + "map_Kd wood.png\n", "line 7: the picture of map_Kd is not read"),
        (_BOX.replace("room.mtl", "other.mtl"), _MTL, 'no file "other.mtl"'),
        (_BOX.replace("room.mtl", "../other.mtl"), _MTL, "leads out of"),
        (_BOX, _MTL + "Ns hard\n", "line 7: Ns: expected 1 numbers"),
    ],
)
def test_what_is_not_read_is_said(obj: str, mtl: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(Incomplete, match=said):
        _imported(tmp_path, obj, mtl)


@pytest.mark.parametrize(
    ("obj", "said"),
    [
        ("v 0 0\n", "line 1: expected three numbers"),
        ("v 0 0 up\n", "line 1: expected three numbers"),
        ("v 0 0 0\nf 1 1 2\n", "line 2: there is no vertex 2; 1 stand before this line"),
        ("v 0 0 0\nf 1 1\n", "line 2: expected three corners"),
        ("v 0 0 0\nf a b c\n", "line 2: expected numbers of vertices, found 'a'"),
        ("v 0 0 0\n", "has no faces"),
    ],
)
def test_what_is_no_obj_is_refused_with_its_line(obj: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        _imported(tmp_path, obj)


def test_materials_are_sent_along(tmp_path: Path) -> None:
    (tmp_path / "room.obj").write_text(_BOX)
    (tmp_path / "room.mtl").write_text(_MTL)
    (tmp_path / "other.mtl").write_text(_MTL)
    assert {*files_of_import(tmp_path / "room.obj")} == {"room.obj", "room.mtl"}
