"""Scenes with more shapes and instances than a document holds."""

import subprocess
import sys
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.document import bounds
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading import crowds, findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.placements import Placements, read_placements

from tests.scene.formats import test_pbrt
from tests.scene.formats.mitsuba_import import imported
from tests.scene.formats.test_gltf_shapes import Model

GROUP = (
    '<bsdf type="diffuse" id="m"/><shape type="shapegroup" id="g">'
    '<shape type="sphere" id="ball"><ref id="m"/></shape></shape>'
)
FEW = 5


@pytest.fixture(autouse=True)
def few_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowds, "MANY", FEW)


def at(place: float, turn: float = 30, scale: str = "2") -> str:
    steps = f'<scale value="{scale}"/><rotate z="1" angle="{turn}"/><translate x="{place}"/>'
    return f'<transform name="to_world">{steps}</transform>'


def instances(count: int) -> str:
    return "".join(f'<shape type="instance"><ref id="g"/>{at(i, i)}</shape>' for i in range(count))


def placements(folder: Path, instance: dict[str, Any]) -> Placements:
    assert set(instance) == {"group", "placements"}
    return read_placements(folder / "out" / instance["placements"]["asset"])


def test_few_instances_are_listed_and_many_are_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "few").mkdir()
    document, _ = imported(tmp_path / "few", GROUP + instances(FEW))
    assert [each["translate"][0] for each in document["instances"]] == list(range(FEW))
    document, _ = imported(tmp_path, GROUP + instances(FEW + 2))
    [instance] = document["instances"]
    found = placements(tmp_path, instance)
    np.testing.assert_allclose(found.shifts, [[i, 0, 0] for i in range(FEW + 2)], atol=1e-12)
    np.testing.assert_allclose(found.scales, 2)
    np.testing.assert_allclose(found.rotations[6, 0, 1], -np.sin(np.radians(6)))


def test_shapes_that_are_alike_become_instances(tmp_path: Path) -> None:
    red = '<bsdf type="diffuse"><rgb name="reflectance" value="0.5,0.1,0.1"/></bsdf>'
    body = "".join(
        f'<shape type="{kind}">{at(i)}</shape>' for i in range(FEW + 1) for kind in ("sphere", "cube")
    )
    document, _ = imported(tmp_path, body + f'<shape type="cube" id="red">{red}</shape>')
    assert [each["name"] for each in document["surfaces"]] == ["red"]
    shapes = [document["groups"][each["group"]][0]["shape"]["type"] for each in document["instances"]]
    assert shapes == ["sphere", "mesh"]
    balls, cubes = (placements(tmp_path, each) for each in document["instances"])
    assert (balls.rotations == np.eye(3)).all()
    np.testing.assert_allclose(cubes.rotations[:, 1, 0], 0.5)
    np.testing.assert_allclose([balls.scales, cubes.scales], 2)


def test_what_is_stretched_or_mirrored_is_one_mesh(tmp_path: Path) -> None:
    cubes = "".join(f'<shape type="cube">{at(3 * i, 0, "1 0.5 2")}</shape>' for i in range(FEW + 1))
    rectangles = "".join(f'<shape type="rectangle">{at(3 * i, 0, "-1 1 1")}</shape>' for i in range(FEW + 1))
    document, _ = imported(tmp_path, cubes + rectangles)
    assert "instances" not in document
    meshes = [load_mesh(tmp_path / "out" / each["shape"]["asset"], "ply") for each in document["surfaces"]]
    assert [len(mesh.indices) for mesh in meshes] == [12 * (FEW + 1), 2 * (FEW + 1)]
    a, b, c = (meshes[0].vertices[meshes[0].indices[:, corner]] for corner in range(3))
    # Volume: triangles face outwards.
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(8 * (FEW + 1))
    a, b, c = (meshes[1].vertices[meshes[1].indices[:, corner]] for corner in range(3))
    # A triangle that is mirrored in its own plane still faces z.
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_members_of_a_group_are_gathered_too(tmp_path: Path) -> None:
    members = "".join(f'<shape type="sphere" id="b{i}">{at(i)}</shape>' for i in range(FEW + 1))
    body = f'<shape type="shapegroup" id="g">{members}</shape><shape type="instance"><ref id="g"/></shape>'
    document, _ = imported(tmp_path, body)
    [instance] = document["instances"]
    [inner] = document["groups"][instance["group"]]
    assert len(placements(tmp_path, inner)) == FEW + 1


def test_parts_of_shapes_can_be_referred_to(tmp_path: Path) -> None:
    """Shapes lie in a file, but named shapes and named parts of shapes are found."""
    body = (
        '<shape type="sphere" id="first"><bsdf type="conductor" id="metal"/></shape>'
        '<shape type="cube"><ref id="metal"/></shape><alias id="first" as="again"/>'
        '<shape type="shapegroup" id="g"><ref id="first"/><ref id="again"/>'
        '<shape type="sphere" id="ball"/></shape><shape type="instance"><ref id="g"/></shape>'
    )
    document, _ = imported(tmp_path, body)
    assert document["surfaces"][1]["kernel"] == "metal"
    [members] = document["groups"].values()
    assert [each.get("kernel") == "metal" for each in members] == [True, True, False]


def test_included_shapes_are_where_they_are_included(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for name, shape in (("scene", '<scene version="3.0.0">{}</scene>'), ("bare", "{}")):
        (tmp_path / "in" / f"{name}.xml").write_text(shape.format('<shape type="sphere" id="x-$name"/>'))
    body = (
        '<default name="name" value="1"/><include filename="scene.xml"/><shape type="shapegroup" id="g">'
        '<include filename="bare.xml"/></shape><shape type="instance"><ref id="g"/></shape>'
    )
    with pytest.raises(InputError, match='the id "x-1" is used twice'):
        imported(tmp_path, body)
    (tmp_path / "in" / "bare.xml").write_text('<shape type="sphere"/>')
    document, _ = imported(tmp_path, body)
    assert len(document["surfaces"]) == len(document["groups"]["g"]) == 1


def test_more_that_is_not_alike_is_refused_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds, "SURFACES", 3)
    grey = '<shape type="cube"><bsdf type="diffuse"><float name="reflectance" value="0.{}"/></bsdf></shape>'
    with pytest.raises(InputError, match="more than 3 surfaces that are not alike"):
        imported(tmp_path, "".join(grey.format(i) for i in range(1, 6)), allow_missing=True)


def test_more_instances_than_a_scene_may_have_are_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bounds, "FLATTENED_INSTANCES", FEW)
    with pytest.raises(InputError, match=f"more than {FEW} of g"):
        imported(tmp_path, GROUP + instances(FEW + 1), allow_missing=True)


def test_a_document_that_would_be_long_shares_files_sooner(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(crowds, "_MAX_ENTRIES", 2)
    document, _ = imported(tmp_path, GROUP + instances(4))
    assert len(document["instances"]) == 1


def test_notes_and_losses_are_told_up_to_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(findings, "_KEPT", 2)
    found = findings.Findings()
    for number in range(4):
        found.note("a", str(number))
        found.lost("b", str(number))
    assert found.notes == ["a: 0", "a: 1", "and 2 notes more"]
    assert [str(each) for each in found.losses] == ["b: 0", "b: 1", "and 2 more"]


def test_pbrts_instances_and_shapes_are_gathered(tmp_path: Path) -> None:
    placed = "".join(
        f'AttributeBegin Translate {i} 0\n 0 Scale 2 2 2 ObjectInstance "o" Shape "sphere" AttributeEnd\n'
        for i in range(FEW + 1)
    )
    body = 'ObjectBegin "o" Shape "disk" "float radius" 3 ObjectEnd\n' + placed
    document, _ = test_pbrt.imported(tmp_path, body)
    first, second = sorted(document["instances"], key=lambda each: each["group"])
    assert "surfaces" not in document
    for each in (first, second):
        np.testing.assert_allclose(
            np.abs(placements(tmp_path, each).shifts), [[i, 0, 0] for i in range(FEW + 1)]
        )
    kinds = {document["groups"][each["group"]][0]["shape"]["type"] for each in (first, second)}
    assert kinds == {"mesh", "sphere"}


def test_an_object_of_which_nothing_is_left_is_looked_at_once(tmp_path: Path) -> None:
    body = 'ObjectBegin "o" Shape "plymesh" "string filename" "none.ply" ObjectEnd Shape "sphere"\n'
    document, found = test_pbrt.imported(tmp_path, body + 'ObjectInstance "o"\n' * 3, allow_missing=True)
    assert "instances" not in document
    assert [each.message for each in found.missing] == ['no file "none.ply"']


def test_instances_of_gltf_are_gathered(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2])
    shifts = model.array([[0, i, 0] for i in range(FEW + 1)])
    instancing = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": shifts}}}
    model.tree["nodes"][0] |= {"scale": [2, 2, 2], "extensions": instancing}
    document, _ = model.imported(tmp_path)
    [instance] = document["instances"]
    np.testing.assert_allclose(placements(tmp_path, instance).shifts[:, 1], 2.0 * np.arange(FEW + 1))


def pieces(count: int) -> Iterator[str]:
    yield f'<scene version="3.0.0"><sensor type="perspective"/>{GROUP}<emitter type="constant"/>'
    for i in range(count):
        yield f'<shape type="instance"><ref id="g"/>{at(i, i)}</shape>\n'
        yield f'<shape type="sphere" id="s{i}"><ref id="m"/>{at(i)}</shape>\n'
    yield "</scene>"


def test_a_shape_takes_little_memory(tmp_path: Path) -> None:
    peaks = []
    for number, count in enumerate((50, 300, 550)):
        (tmp_path / "a.xml").write_text("".join(pieces(count)))
        tracemalloc.start()
        import_scene(tmp_path / "a.xml", tmp_path / f"out-{number}", ImportOptions())
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # As elements and objects one took 5,500 bytes; the first import loads modules.
    assert peaks[2] - peaks[1] < 500 * 800


_IMPORT = """
import resource, sys
from pathlib import Path
resource.setrlimit(resource.RLIMIT_AS, (2 * 2**30, 2 * 2**30))
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions
import_scene(Path(sys.argv[1]), Path(sys.argv[2]), ImportOptions())
"""


@pytest.mark.soak
def test_a_million_shapes_are_imported_and_rendered(tmp_path: Path) -> None:
    """Half a million instances and as many spheres; 2 GiB of address space for the import, all included."""
    with (tmp_path / "a.xml").open("w") as file:
        file.writelines(pieces(500_000))
    subprocess.run([sys.executable, "-c", _IMPORT, tmp_path / "a.xml", tmp_path / "out"], check=True)
    image = ["--width", "32", "--height", "32", "--samples", "4", "-o", tmp_path / "a.exr"]
    command = [sys.executable, "-m", "nocturne_client", "render", tmp_path / "out" / "scene.json", *image]
    subprocess.run([str(word) for word in command], check=True)
