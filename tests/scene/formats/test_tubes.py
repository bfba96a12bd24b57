"""Curves as meshes, against what is known of them: areas, distances and normals."""

from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading import tubes
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.triangles import Triangles

from tests.scene.formats.mitsuba_import import imported


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
    curve = tubes.spline(points[None])[0]
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
