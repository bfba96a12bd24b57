"""A small valid scene document to spoil, and a blob store to compile into."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document, parse_document
from nocturne_scene.errors import InputError

Document = dict[str, Any]
Compile = Callable[[Document], scene_pb2.CompiledScene]


@pytest.fixture
def document() -> Document:
    """A valid scene: surface 0 is a sphere, 1 a luminaire, 2 an inline mesh of two triangles."""
    return {
        "nocturne": 1,
        "spectra": {"white": {"table": [[400, 0.5], [700, 0.6]]}, "red": 0.3},
        "kernels": {"white": {"type": "lambertian", "reflectance": "white"}},
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, -2],
            "look_at": [0, 0, 1],
            "vertical_field_of_view_degrees": 40,
        },
        "surfaces": [
            {"shape": {"type": "sphere", "centre": [0, 0, 3], "radius": 1}, "kernel": "white"},
            {
                "shape": {"type": "quad", "corner": [0, 3, 3], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]},
                "kernel": {"type": "lambertian", "reflectance": 0.5},
                "luminaire": {"radiance": {"blackbody": 3000}},
            },
            {
                "shape": {
                    "type": "mesh",
                    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]],
                    "triangles": [[0, 1, 2], [1, 3, 2]],
                },
                "kernel": {"type": "lambertian", "reflectance": "red"},
            },
        ],
    }


@pytest.fixture
def blobs(tmp_path: Path) -> BlobStore:
    return BlobStore(tmp_path / "blobs")


@pytest.fixture
def compiled(blobs: BlobStore) -> Compile:
    """Compile a document that is given as decoded JSON, and read the result back."""

    def run(document: Document) -> scene_pb2.CompiledScene:
        output = compile_scene(check_document(document), blobs)
        return scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())

    return run


def expect_problem(document: Document, blobs: BlobStore, place: str, words: str) -> None:
    """Fails unless the compiler's first complaint about a document is at a place and has these words."""
    with pytest.raises(InputError) as caught:
        compile_scene(parse_document(json.dumps(document)), blobs)
    problem = str(caught.value.problems[0])
    assert problem.startswith(f"{place}: ")
    assert words in problem


def files_in(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())
