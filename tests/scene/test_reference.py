"""The committed reference of the scene document is the one that the schema gives, and its examples work."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.local.compiled import store_files
from nocturne_client.scene_files import read_scene
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document import reference
from nocturne_scene.document.node import Node
from nocturne_scene.document.read import check_document
from nocturne_scene.document.reference_examples import examples
from nocturne_scene.document.reference_pages import SHOWN_WITH

from examples.reference_pictures import MAX_BYTES, picture_of, scene_of, shown, write_files

DOCS = Path(__file__).parents[2] / "docs" / "reference"
EXAMPLES = examples()
TYPES = set(reference.json_schema()["$defs"])


def test_the_committed_reference_is_current() -> None:
    made = reference.pages(DOCS)
    outdated = [path for path, text in made.items() if path.read_text("utf-8") != text]
    assert outdated == [], "make it again: python -m nocturne_scene.document.reference docs/reference"
    assert set((DOCS / "scene").glob("*.md")) <= set(made)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files that examples name."""
    made = tmp_path_factory.mktemp("reference")
    write_files(made)
    return made


def _nodes(value: Any) -> Iterator[Node]:
    """All parts of a document."""
    if isinstance(value, Node):
        yield value
        for name in type(value).model_fields:
            yield from _nodes(getattr(value, name))
    elif isinstance(value, dict):
        for each in value.values():
            yield from _nodes(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _nodes(each)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_example_of_a_type_has_it_and_compiles(name: str, folder: Path, tmp_path: Path) -> None:
    scene = folder / f"{name}.json"
    scene.write_text(json.dumps(scene_of(name, EXAMPLES[name])), encoding="utf-8")
    on_disk = read_scene(scene)
    document = check_document(on_disk.document)
    found = {type(node).__name__ for node in _nodes(document)}
    assert {name, *(each for each, other in SHOWN_WITH.items() if other == name)} <= found
    blobs = BlobStore(tmp_path / "blobs", durable=False)
    store_files(on_disk, blobs)
    output = compile_scene(document, blobs)
    assert output.dropped == []


def test_each_type_has_an_example() -> None:
    assert {*EXAMPLES, *SHOWN_WITH} - {"SceneDocument"} == TYPES


@pytest.mark.parametrize("name", shown())
def test_pictures_are_there_and_small(name: str) -> None:
    """Made by `python -m examples.reference_pictures`."""
    assert picture_of(name).read_bytes()[8:12] == b"WEBP"
    assert picture_of(name).stat().st_size <= MAX_BYTES
