"""A lamp of a group is one lamp for each place where an instance shows it, with all of its light."""

import copy
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra

from .conftest import Compile, expect_problem
from .test_lights import photometric

_PLACES: list[dict[str, Any]] = [
    {"translate": [0.5, 2.0, 0.0]},
    {"translate": [-1.0, 2.0, 1.0], "rotate": {"axis": [0, 1, 0], "degrees": 90}},
    {"translate": [0.0, 1.0, -1.0], "rotate": {"axis": [1, 2, 3], "degrees": 200}, "scale": 0.5},
]


def _lamp(blobs: BlobStore, **light: Any) -> dict[str, Any]:
    quad = {"type": "quad", "corner": [0, 0, 0], "edge_u": [0.6, 0, 0], "edge_v": [0, 0, 0.6]}
    light = light or {"profile": {"asset": photometric(blobs), "lumens": 1000}, "two_sided": True}
    luminaire = {"radiance": {"illuminant": "D65", "luminance": 1}} | light
    return {"shape": quad, "kernel": {"type": "lambertian", "reflectance": 0}, "luminaire": luminaire}


def _corners(scene: scene_pb2.CompiledScene, index: int) -> Any:
    quad = scene.surfaces[index].quad
    return np.array([[v.x, v.y, v.z] for v in (quad.corner, quad.edge_u, quad.edge_v)])


@pytest.mark.parametrize("nested", [False, True])
def test_it_is_as_if_each_stood_in_the_document(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore, nested: bool
) -> None:
    direct = copy.deepcopy(document)
    direct["surfaces"][1:] = [_lamp(blobs) | place for place in _PLACES]
    del document["surfaces"][1:]
    document["groups"] = {"lamp": [_lamp(blobs)], "row": [{"group": "lamp"}]}
    document["instances"] = [{"group": "row" if nested else "lamp"} | place for place in _PLACES]
    one, other = compiled(document), compiled(direct)
    assert len(one.luminaires) == len(_PLACES)
    assert not one.instances
    for here, there in zip(one.luminaires, other.luminaires, strict=True):
        assert here.intensity.values == there.intensity.values
        for axis in ("axis", "zero"):
            a, b = (getattr(each.intensity, axis) for each in (here, there))
            assert (a.x, a.y, a.z) == pytest.approx((b.x, b.y, b.z), abs=1e-12)
        found = _corners(one, here.surface)
        assert found == pytest.approx(_corners(other, there.surface), abs=1e-12)


def test_each_has_the_flux_that_the_document_says(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    """1000 lm of 0.6 x 0.6 m: 1000 / (0.36 pi) cd/m2, and four times as much where it is half as large."""
    document["surfaces"][1:] = []
    document["groups"] = {"lamp": [_lamp(blobs, lumens=1000)]}
    document["instances"] = [{"group": "lamp"} | place for place in _PLACES]
    scene = compiled(document)
    found = [spectra.luminance(scene.spectra[each.radiance.spectrum]) for each in scene.luminaires]
    assert found == pytest.approx([1000 / (0.36 * np.pi) * factor for factor in (1, 1, 4)], rel=1e-6)


def test_what_is_beside_it_is_shared(document: dict[str, Any], compiled: Compile, blobs: BlobStore) -> None:
    housing = {
        "shape": {"type": "sphere", "centre": [0, 1, 0], "radius": 0.1},
        "kernel": _lamp(blobs)["kernel"],
    }
    document["surfaces"][1:] = []
    document["groups"] = {"lamp": [_lamp(blobs), housing]}
    document["instances"] = [{"group": "lamp"} | place for place in _PLACES]
    scene = compiled(document)
    assert len(scene.instances) == len(scene.luminaires) == len(_PLACES)
    assert [surface.group for surface in scene.surfaces] == [0, 0, 0, 0, 1]


@pytest.mark.parametrize("of", ["instance", "lamp"])
def test_it_can_not_move(document: dict[str, Any], blobs: BlobStore, of: str) -> None:
    motion = {"motion": {"translate": [0, 0.1, 0]}}
    document["groups"] = {"lamp": [_lamp(blobs) | (motion if of == "lamp" else {})]}
    document["instances"] = [{"group": "lamp"} | (motion if of == "instance" else {})]
    expect_problem(document, blobs, "$.instances[0]", "moves, and shows a lamp with a photometric file")


def test_a_file_that_can_not_be_read_is_told_once(document: dict[str, Any], blobs: BlobStore) -> None:
    bad = {"profile": {"asset": f"sha256:{blobs.put(b'no lamp')}"}}
    document["groups"] = {"lamp": [_lamp(blobs, **bad)]}
    document["instances"] = [{"group": "lamp"} | place for place in _PLACES]
    expect_problem(
        document, blobs, "$.groups.lamp[0].luminaire.profile.asset", "line 1: there is no line TILT="
    )
