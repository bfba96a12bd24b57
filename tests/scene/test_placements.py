"""Instances whose placements are in a file."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.placements import COLUMNS, read_placements, write_placements
from nocturne_scene.simplify.candidates import candidates

from tests.scene.conftest import Compile, Document, expect_problem

LEAF = {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}, "kernel": "white"}
# Shift, scale, axis and degrees; an axis that turns nothing needs no length.
ROWS: list[list[float]] = [
    [1, 2, 3, 0.5, 0, 0, 2, 90],
    [0, 0, 9, 2, 0, 0, 0, 0],
    [-4, 0.1, 0, 1, 1, 1, 0, 33.3],
]
HEADER = "ply\nformat ascii 1.0\nelement vertex {}\n{}end_header\n"


def stored(blobs: BlobStore, content: bytes) -> str:
    return f"sha256:{blobs.put(content)}"


def file_of(rows: list[list[float]], folder: Path) -> bytes:
    write_placements(folder / "rows.ply", np.array(rows, dtype=np.float64))
    return (folder / "rows.ply").read_bytes()


def listed(row: list[float]) -> dict[str, Any]:
    turn = {"axis": row[4:7], "degrees": row[7]}
    return {"translate": row[:3], "scale": row[3]} | ({"rotate": turn} if row[7] else {})


def text(names: str, *lines: str) -> bytes:
    properties = "".join(f"property float {name}\n" for name in names.split())
    return (HEADER.format(len(lines), properties) + "\n".join(lines) + "\n").encode()


def transforms(scene: scene_pb2.CompiledScene) -> tuple[list[int], np.ndarray]:
    return [each.group for each in scene.instances], np.array([each.transforms for each in scene.instances])


def test_a_file_places_as_a_list_does(
    document: Document, compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    around = {"translate": [0, 0, 7], "scale": 3, "rotate": {"axis": [0, 1, 0], "degrees": 20}}
    document["groups"] = {
        "leaf": [LEAF],
        "twig": [LEAF, *({"group": "leaf"} | listed(row) for row in ROWS)],
        "tree": [{"group": "twig"} | listed(row) for row in ROWS],
    }
    document["instances"] = [{"group": "tree", "motion": {"translate": [0, 0, 1]}} | around]
    expected = transforms(compiled(document))
    placements = {"asset": stored(blobs, file_of(ROWS, tmp_path))}
    by_file = copy.deepcopy(document)
    by_file["groups"]["twig"][1:] = [{"group": "leaf", "placements": placements}]
    by_file["groups"]["tree"] = [{"group": "twig", "placements": placements}]
    found = transforms(compiled(by_file))
    # All twigs come first, then their contents.
    assert sorted(found[0]) == sorted(expected[0])
    order = [np.lexsort(np.column_stack([rows.round(9), groups]).T) for groups, rows in (found, expected)]
    np.testing.assert_allclose(found[1][order[0]], expected[1][order[1]], rtol=0, atol=1e-12)


def test_a_file_as_text_has_what_it_needs_only(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(text("red z y x", "9 3 2 1", "9 6 5 4"))
    found = read_placements(tmp_path / "a.ply")
    assert found.shifts.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert found.scales.tolist() == [1, 1]
    assert (found.rotations == np.eye(3)).all()


def test_quarter_turns_are_exact(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(text(" ".join(COLUMNS), "0 0 0 1 0 0 5 -270"))
    assert read_placements(tmp_path / "a.ply").rotations.tolist() == [[[0, -1, 0], [1, 0, 0], [0, 0, 1]]]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"solid", "not a PLY file"),
        (text("x y"), "no property z"),
        (text("x y z"), "no placements"),
        (text("x y z", "1 2"), "1 lines of 3 numbers"),
        (text("x y z", "1 2 nan"), "placement 0 has numbers that are not finite"),
        (text("x y z scale", "1 2 3 1", "1 2 3 0"), "placement 1 has a scale of 0"),
        (text("x y z degrees", "1 2 3 4"), "missing: axis_x, axis_y, axis_z"),
        (text(" ".join(COLUMNS), "1 2 3 4 0 0 0 8"), "placement 0 turns about an axis without length"),
        (HEADER.format(1, "property list int int x\nproperty int y\nproperty int z\n").encode(), "no lists"),
    ],
)
def test_what_is_wrong_with_a_file(content: bytes, words: str, tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(content + b"\n" * 8)
    with pytest.raises(UnusableMeshError, match=words):
        read_placements(tmp_path / "a.ply")


def test_a_wrong_file_is_told_with_its_place(document: Document, blobs: BlobStore) -> None:
    document["groups"] = {"leaf": [LEAF]}
    document["instances"] = [{"group": "leaf", "placements": {"asset": stored(blobs, b"solid")}}]
    expect_problem(document, blobs, "$.instances[0].placements.asset", "not a PLY file")
    document["instances"][0]["placements"]["asset"] = stored(blobs, text("x y z", "2e12 0 0"))
    expect_problem(document, blobs, "$.instances[0]", "farther than")


def test_too_many_placements_are_refused_before_they_are_read(document: Document, blobs: BlobStore) -> None:
    header = HEADER.format(1500, "".join(f"property char {name}\n" for name in "xyz"))
    asset = stored(blobs, header.replace("ascii", "binary_little_endian").encode() + bytes(4500))
    document["groups"] = {
        "leaf": [LEAF],
        "twig": [{"group": "leaf", "placements": {"asset": asset}}],
    }
    document["instances"] = [{"group": "twig", "placements": {"asset": asset}}]
    expect_problem(document, blobs, "$.instances", "2250000 instances once groups in groups are flattened")


def test_the_origin_is_near_what_a_file_places(
    document: Document, compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    far: list[list[float]] = [[1e6, 0, 0, 1, 0, 0, 0, 0], [1e6 + 5, 0, 0, 1, 0, 0, 0, 0]]
    document["surfaces"], document["environment"] = [], {"radiance": 1}
    document["groups"] = {"leaf": [LEAF]}
    document["sensor"] |= {"position": [1e6, 0, -9], "look_at": [1e6, 0, 0]}
    document["instances"] = [
        {"group": "leaf", "placements": {"asset": stored(blobs, file_of(far, tmp_path))}}
    ]
    _, rows = transforms(compiled(document))
    assert np.abs(rows).max() < 1024


def test_a_preflight_leaves_files_as_they_are(document: Document, tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(file_of(ROWS, tmp_path))
    placements = {"asset": "sha256:" + "0" * 64}
    document["groups"] = {"leaf": [LEAF], "twig": [{"group": "leaf", "placements": placements}]}
    document["instances"] = [
        {"group": "leaf", "placements": placements},
        {"group": "twig", "translate": [0, 0, 900]},
        {"group": "twig"},
    ]
    [half] = [each for each in candidates(document, lambda _: tmp_path / "a.ply") if "50%" in each.name]
    assert half.applied(document)["instances"] == [document["instances"][0], document["instances"][2]]
