"""A scene that is measured with many sensors and seeds: its parts are read and converted once."""

from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import measured, textures
from nocturne_scene.meshes import files
from nocturne_scene.textures import environment_maps

from tests.pictures import write_exr
from tests.scene.conftest import Compile, Document

_PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 1 2
3 0 2 3
"""


@pytest.fixture
def large(document: Document, blobs: BlobStore, tmp_path: Path) -> Document:
    """A mesh, a texture and a sky."""
    rng = np.random.default_rng(1)
    picture = blobs.put(write_exr(tmp_path / "a.exr", rng.random((8, 16, 3)), "RGB").read_bytes())
    grey = blobs.put(write_exr(tmp_path / "b.exr", rng.random((8, 8, 3)), "RGB").read_bytes())
    mesh = {"type": "mesh", "asset": f"sha256:{blobs.put(_PLY.encode())}", "format": "ply"}
    document["environment"] = {"asset": f"sha256:{picture}"}
    texture = {"texture": {"asset": f"sha256:{grey}"}}
    document["surfaces"][1]["kernel"] = {"type": "lambertian", "reflectance": texture}
    placed = {"shape": mesh, "kernel": "white", "translate": [3, 0, 0]}
    document["surfaces"] += [{"shape": mesh, "kernel": "white"}, placed]
    return document


def _with_sensor(document: Document, x: float, seed: int) -> Document:
    return {**document, "sensor": {**document["sensor"], "position": [x, 0, -2]}, "tracing": {"seed": seed}}


def _refuse(*_: Any, **__: Any) -> NoReturn:
    raise AssertionError("a file was read again")


def test_other_sensors_and_seeds_read_no_file_again(
    large: Document, compiled: Compile, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = compiled(large)
    monkeypatch.setattr(files, "load_mesh", _refuse)
    monkeypatch.setattr(textures, "opened", _refuse)
    monkeypatch.setattr(environment_maps, "convert", _refuse)
    second = compiled(_with_sensor(large, 0.5, 7))
    assert second.sensor.position.x == pytest.approx(0.5)
    assert second.tracing.seed == 7
    second.sensor.CopyFrom(first.sensor)
    second.tracing.CopyFrom(first.tracing)
    assert second == first


def test_what_is_shared_is_what_a_new_store_gets(
    large: Document, compiled: Compile, blobs: BlobStore
) -> None:
    compiled(large)
    again = compiled(_with_sensor(large, 0.5, 7))
    for note in (blobs.root / "notes").glob("*/*"):
        note.unlink()
    assert compiled(_with_sensor(large, 0.5, 7)) == again


def test_what_is_gone_or_noted_wrongly_is_made_again(
    large: Document, compiled: Compile, blobs: BlobStore
) -> None:
    first = compiled(large)
    for blob in (first.environment.map.blob, first.textures[0].blob, first.surfaces[3].mesh.blob):
        blobs.path(blob.hex()).unlink()
    assert compiled(large) == first
    assert blobs.has(first.environment.map.blob.hex())
    for text in ("", "7", "[]", '["x", 3]', "null", '[[1, 2], "a"]'):
        for note in (blobs.root / "notes").glob("*/*"):
            note.write_text(text)
        assert compiled(large) == first


def test_another_placement_is_another_mesh(large: Document, compiled: Compile) -> None:
    first = compiled(large)
    large["surfaces"][3]["translate"] = [0, 0, 1]
    second = compiled(large)
    assert second.surfaces[3].mesh.blob != first.surfaces[3].mesh.blob
    assert second.surfaces[4] == first.surfaces[4]


def test_a_measured_reflection_is_converted_once(
    document: Document, compiled: Compile, blobs: BlobStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    converted: list[bytes] = []

    def convert(data: bytes) -> bytes:
        converted.append(data)
        return b"a table"

    monkeypatch.setattr(measured, "_from_merl", convert)
    file = blobs.put(b"of MERL")
    document["kernels"]["white"] = {"type": "measured", "asset": f"sha256:{file}", "format": "merl"}
    first = compiled(document)
    second = compiled(_with_sensor(document, 0.5, 7))
    assert converted == [b"of MERL"]
    assert second.kernels == first.kernels
