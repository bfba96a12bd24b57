"""Curves as meshes, against their known areas, distances and normals."""

import json
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading import tubes
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.triangles import Triangles
from scipy.interpolate import BPoly, BSpline

from tests.scene.formats.mitsuba_import import SPHERE, imported


def area(mesh: Triangles) -> float:
    a, b, c = (mesh.vertices[mesh.indices[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def faces_outwards(mesh: Triangles) -> bool:
    """Whether triangles lie on the side of their normals; those without an area do on none."""
    assert mesh.normals is not None
    a, b, c = (mesh.vertices[mesh.indices[:, corner]] for corner in range(3))
    said = mesh.normals[mesh.indices].sum(axis=1)
    return bool(np.all(np.einsum("ij,ij->i", np.cross(b - a, c - a), said) >= -1e-12))


def test_a_straight_spline_is_a_cylinder() -> None:
    """Of n control points at distance 1 it runs over n - 3."""
    points = np.array([[0, 0, z, 0.1] for z in range(6)], dtype=np.float64)
    curve = tubes.along(points, 3, "bspline")
    assert curve[[0, -1], 2] == pytest.approx([1, 4])
    mesh = tubes.tubes([curve])
    assert area(mesh) == pytest.approx(2 * np.pi * 0.1 * 3, rel=5e-3)
    assert faces_outwards(mesh)


def test_a_bent_tube_is_as_far_from_its_curve_as_it_is_thick() -> None:
    t = np.linspace(0, 4 * np.pi, 400)
    curve = np.stack([np.cos(t), np.sin(t), 0.1 * t, 0.05 + 0 * t], 1)
    mesh = tubes.tubes([curve, curve[::-1]])
    apart = np.linalg.norm(mesh.vertices[:, None] - curve[None, :, :3], axis=2).min(axis=1)
    assert apart == pytest.approx(0.05, rel=1e-3)
    assert faces_outwards(mesh)


def test_beads_are_what_is_near_to_a_cone_between_balls() -> None:
    """All of it is on the hull of two balls: the largest r(s) - |x - p(s)| over the segment is zero."""
    line = np.array([[0, 0, 0, 0.5], [2, 0, 0, 0.2]])
    mesh = tubes.beads([line])
    assert faces_outwards(mesh)
    s = np.linspace(0, 1, 4001)[:, None]
    along = line[0] + s * (line[1] - line[0])
    inside = (along[:, 3] - np.linalg.norm(mesh.vertices[:, None] - along[None, :, :3], axis=2)).max(axis=1)
    # Parts of the balls lie inside.
    assert inside.min() == pytest.approx(0, abs=1e-6)
    assert np.count_nonzero(inside < 1e-6) > len(inside) / 2


@pytest.mark.parametrize("kind", ["bsplinecurve", "linearcurve"])
def test_curves_are_imported(tmp_path: Path, kind: str) -> None:
    (tmp_path / "in").mkdir()
    lines = [f"{x} 0 0 0.1" for x in range(5)] + [""] + [f"0 {y} 0 0.1" for y in range(4)]
    (tmp_path / "in" / "hair.txt").write_text("\n".join(lines))
    body = f'<shape type="{kind}"><string name="filename" value="hair.txt"/>' + (
        '<transform name="to_world"><scale value="2"/></transform></shape>'
    )
    document, found = imported(tmp_path, body)
    assert not found.missing
    mesh = load_mesh(tmp_path / "out" / document["surfaces"][0]["shape"]["asset"], "ply")
    # Radii stay, and balls reach beyond the ends.
    expected = [6.0, 4.0, 0.1] if kind == "bsplinecurve" else [8.1, 6.1, 0.1]
    assert mesh.vertices.max(axis=0) == pytest.approx(expected, abs=1e-3)


def test_curves_that_are_none_are_named(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    body = '<shape type="bsplinecurve"><string name="filename" value="hair.txt"/></shape>'
    for text, said in (("0 0 0 1\n1 0 0 1\n", "has no curve of 4 points"), ("0 0 x 1", "hair.txt:1")):
        (tmp_path / "in" / "hair.txt").write_text(text)
        with pytest.raises(InputError, match=said):
            imported(tmp_path, body)


@pytest.mark.parametrize("basis", tubes.BASES)
@pytest.mark.parametrize("degree", [2, 3])
def test_curves_are_those_of_scipy(basis: str, degree: int) -> None:
    points = np.random.default_rng(4).normal(size=(7, 3))
    found = tubes.along(points, degree, basis)
    t = np.linspace(0, 1, tubes.STEPS + 1)
    if basis == "bspline":
        whole = BSpline(np.arange(-degree, len(points) + 1.0), points, degree)
        expected = whole(np.linspace(0, len(points) - degree, len(found)))
    else:
        starts = range(0, len(points) - 1, degree)
        pieces = [
            BPoly(points[start : start + degree + 1, None, :], [0.0, 1.0])(t)[(start > 0) :]
            for start in starts
        ]
        expected = np.concatenate(pieces)
    assert found == pytest.approx(expected, abs=1e-12)


def test_control_points_that_make_no_curve_are_refused() -> None:
    for count, basis in ((3, "bspline"), (5, "bezier"), (0, "bezier")):
        with pytest.raises(ValueError, match="control points"):
            tubes.along(np.zeros((count, 3)), 3, basis)


def test_curves_of_pbrt_that_look_the_same_are_one_mesh(tmp_path: Path) -> None:
    """A width is a diameter, and grows with the coordinates."""
    curve = 'Shape "curve" "point3 P" [ 0 0 0  1 0 0  2 0 0  {} 0 0 ] "float width" {}\n'
    (tmp_path / "a.pbrt").write_text(
        'Camera "perspective"\nWorldBegin\nLightSource "infinite"\nScale 2 2 2\n'
        + curve.format(3, 0.1)
        + curve.format(4, 0.2)
        + 'Material "conductor"\n'
        + curve.format(5, 0.1)
    )
    found = import_scene(tmp_path / "a.pbrt", tmp_path / "out", ImportOptions())
    surfaces = json.loads(found.document.read_text())["surfaces"]
    meshes = [load_mesh(tmp_path / "out" / each["shape"]["asset"], "ply") for each in surfaces]
    # pbrt's world is a mirror image of ours.
    assert [np.ptp(mesh.vertices, axis=0).tolist() for mesh in meshes] == [
        pytest.approx([8, 0.4, 0.4], abs=2e-2),
        pytest.approx([10, 0.2, 0.2], abs=2e-2),
    ]
    assert not found.missing


def test_a_mesh_without_an_area_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    body = '<shape type="obj"><string name="filename" value="line.obj"/></shape>'
    document, found = imported(tmp_path, body + SPHERE)
    assert [each["shape"]["type"] for each in document["surfaces"]] == ["sphere"]
    assert any("without an area" in note for note in found.notes)
