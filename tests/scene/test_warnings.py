"""What a scene says that can hardly be meant."""

import json
from typing import Any

import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document

GLASS = {"type": "dielectric", "index": 1.5}
TETRAHEDRON = {
    "type": "mesh",
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
}
OPEN = {**TETRAHEDRON, "triangles": TETRAHEDRON["triangles"][:3]}


def warnings(document: dict[str, Any], blobs: BlobStore) -> list[str]:
    return compile_scene(parse_document(json.dumps(document)), blobs).warnings


def test_a_scene_without_fault_has_no_warning(document: dict[str, Any], blobs: BlobStore) -> None:
    assert warnings(document, blobs) == []


@pytest.mark.parametrize(
    "shape",
    [
        TETRAHEDRON,
        {"type": "sphere", "centre": [0, 0, 0], "radius": 1},
        {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]},
    ],
)
def test_a_closed_body_of_glass_is_right(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any]
) -> None:
    document["surfaces"].append({"shape": shape, "kernel": GLASS})
    assert warnings(document, blobs) == []


@pytest.mark.parametrize(
    ("shape", "edges"),
    [(OPEN, 3), ({"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}, 4)],
)
def test_an_open_body_of_glass_is_told(
    document: dict[str, Any], blobs: BlobStore, shape: dict[str, Any], edges: int
) -> None:
    document["surfaces"].append({"shape": shape, "kernel": GLASS})
    [told] = warnings(document, blobs)
    place = f"$.surfaces[{len(document['surfaces']) - 1}].shape: "
    assert told.startswith(f"{place}bounds a body, and is open: {edges} edges")


def test_an_open_body_in_a_group_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["groups"] = {"glasses": [{"shape": OPEN, "kernel": GLASS}]}
    document["instances"] = [{"group": "glasses"}]
    [told] = warnings(document, blobs)
    assert told.startswith("$.groups.glasses[0].shape: bounds a body, and is open")


def test_surfaces_close_a_body_together(document: dict[str, Any], blobs: BlobStore) -> None:
    for triangle in TETRAHEDRON["triangles"]:
        shape = {**TETRAHEDRON, "triangles": [triangle]}
        document["surfaces"].append({"shape": shape, "kernel": GLASS})
    assert warnings(document, blobs) == []
    document["surfaces"].pop()
    assert "together with 2 other surfaces" in warnings(document, blobs)[0]


def test_a_mixture_that_loses_light_is_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["tracing"] = {"mixture": {"kernel": 0, "luminaires": 1}}
    [told] = warnings(document, blobs)
    assert told.startswith("$.tracing.mixture: neither kernel nor uniform")
    document["tracing"]["mixture"]["uniform"] = 0.1
    assert warnings(document, blobs) == []
