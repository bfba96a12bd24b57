"""glTF's accessors without a buffer view: zeros, but for what their sparse part says (section 3.6.2.3)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError

from tests.scene.formats.test_gltf_shapes import SQUARE, Model

# https://github.com/gltf-rs/gltf/issues/266, https://github.com/vpenades/SharpGLTF/issues/202,
# https://github.com/godotengine/godot/issues/76875.


def bare(model: Model, count: int, kind: str) -> int:
    model.tree["accessors"].append({"componentType": 5126, "count": count, "type": kind})
    return len(model.tree["accessors"]) - 1


def test_a_morph_target_of_zeros_moves_nothing(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2], targets=[{"POSITION": bare(model, 4, "VEC3")}])
    model.tree["meshes"][0]["weights"] = [1.0]
    found = model.triangles(tmp_path)
    assert sorted(found.vertices[found.indices[0]].tolist()) == sorted(SQUARE[:3].tolist())


def test_coordinates_of_zeros(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2], attributes={"TEXCOORD_0": bare(model, 4, "VEC2")})
    found = model.triangles(tmp_path)
    assert found.coordinates is not None
    assert np.unique(found.coordinates[found.indices].reshape(-1, 2), axis=0).tolist() == [[0, 1]]


@pytest.mark.parametrize("kind", ["B", "<u2"])
def test_positions_of_a_sparse_part_alone(tmp_path: Path, kind: str) -> None:
    model = Model()
    primitive = model.mesh([0, 1, 2])
    where, what = (model.array(*each) for each in (([1, 2], kind), (SQUARE[1:3], "<f4")))
    accessors = model.tree["accessors"]
    sparse: dict[str, Any] = {"count": 2}
    sparse["indices"] = {each: accessors[where][each] for each in ("bufferView", "componentType")}
    sparse["values"] = {"bufferView": accessors[what]["bufferView"]}
    primitive["attributes"]["POSITION"] = bare(model, 4, "VEC3")
    accessors[-1]["sparse"] = sparse
    found = model.triangles(tmp_path)
    assert sorted(found.vertices[found.indices[0]].tolist()) == sorted(SQUARE[:3].tolist())


def test_normals_of_zeros_are_none(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2], attributes={"NORMAL": bare(model, 4, "VEC3")})
    assert np.all(np.isfinite(model.triangles(tmp_path).vertices))


def test_more_zeros_than_a_mesh_has(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2])["attributes"]["COLOR_0"] = bare(model, 2**26, "VEC3")
    with pytest.raises(InputError, match="zeros are too many"):
        model.imported(tmp_path)
