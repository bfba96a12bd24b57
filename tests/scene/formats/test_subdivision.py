"""Loop's subdivision."""

from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.subdivision import subdivided
from nocturne_scene.meshes.files import load_mesh

from tests.scene.formats.test_pbrt import imported

OCTAHEDRON = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]], np.int64
)


def test_corners_of_an_octahedron_go_to_their_limits() -> None:
    """With four neighbours beta is 3/32, and the limit takes 1/8 of each; here their sum is 0."""
    for levels in (0, 1, 3):
        mesh = subdivided(OCTAHEDRON, FACES, levels)
        assert len(mesh.indices) == 8 * 4**levels
        assert mesh.vertices[:6] == pytest.approx(0.5 * OCTAHEDRON)
        assert mesh.normals is not None
        assert mesh.normals[:6] == pytest.approx(OCTAHEDRON)


def test_a_flat_lattice_stays_flat_and_its_sides_straight() -> None:
    columns, rows = np.meshgrid(np.arange(4.0), np.arange(4.0))
    points = np.stack([columns.ravel(), rows.ravel(), np.zeros(16)], 1)
    first = np.array([4 * row + column for row in range(3) for column in range(3)])
    triangles = np.concatenate(
        [np.stack([first, first + 1, first + 5], 1), np.stack([first, first + 5, first + 4], 1)]
    )
    mesh = subdivided(points, triangles, 2)
    assert np.abs(mesh.vertices[:, 2]).max() == 0
    assert mesh.normals == pytest.approx(np.tile([0.0, 0.0, 1.0], (len(mesh.vertices), 1)))
    side = mesh.vertices[[1, 2]]
    assert side[:, 1] == pytest.approx([0, 0])
    assert side[:, 0] == pytest.approx([1, 2])
    # Around an inner vertex of six neighbours nothing moves.
    assert mesh.vertices[5] == pytest.approx([1, 1, 0])


def test_edges_of_three_triangles_are_refused() -> None:
    with pytest.raises(ValueError, match="share an edge"):
        subdivided(OCTAHEDRON, np.array([[0, 2, 4], [0, 2, 5], [0, 2, 1]]), 1)


def test_pbrts_become_meshes(tmp_path: Path) -> None:
    points = " ".join(map(str, OCTAHEDRON.ravel()))
    shape = f'Shape "loopsubdiv" "integer levels" 2 "point3 P" [{points}]'
    indices = f'"integer indices" [{" ".join(map(str, FACES.ravel()))}]'
    document, found = imported(tmp_path, f"{shape} {indices}")
    [surface] = document["surfaces"]
    mesh = load_mesh(found.document.parent / surface["shape"]["asset"], "ply")
    assert len(mesh.indices) == 128


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("", "needs"),
        ('"point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 5]', "vertex"),
        ('"point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2] "integer levels" 99', "levels"),
    ],
)
def test_bad_ones_are_told(body: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        imported(tmp_path, f'Shape "loopsubdiv" {body}')
