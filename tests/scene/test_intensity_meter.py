"""An intensity meter's sphere holds a lamp; objects beyond cause a warning, and are traced from the meter."""

import json
from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film

FOG = {"media": {"fog": {"absorption": 0.2}}}
BEYOND: dict[str, dict[str, Any]] = {
    "$.environment": {"environment": {"radiance": 1.0}},
    "$.distant": {"distant": [{"direction": [0, 1, 0], "radiance": 1.0}]},
    "$.unbounded_media": {**FOG, "unbounded_media": ["fog"]},
    "$.surfaces[1].shape": {"more": {"shape": {"type": "sphere", "centre": [0, 2, 0], "radius": 0.1}}},
}


def _lamp(direction: str = "auto", **more: Any) -> dict[str, Any]:
    lamp = {
        "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 0.1},
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": 1.0},
    }
    surfaces = [lamp, *([more.pop("more") | {"kernel": lamp["kernel"]}] if "more" in more else [])]
    sensor = {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": 0.3}
    return {
        "nocturne": 1,
        "sensor": sensor,
        "surfaces": surfaces,
        "tracing": {"direction": direction},
        **more,
    }


@pytest.mark.parametrize("place", BEYOND)
def test_what_is_beyond_the_sphere_is_warned_of(place: str, blobs: BlobStore) -> None:
    """By photons from luminaires an intensity under a sky of radiance 1 read 6,883, by those from the meter
    20,635 (2,293 of the lamp alone, and the sky through the sphere)."""
    found = compile_scene(parse_document(json.dumps(_lamp(**BEYOND[place]))), blobs, Film(64, 64, 64))
    assert any(
        each.sentence.startswith(place) and "sphere of 0.3 m" in each.sentence for each in found.warnings
    )
    scene = scene_pb2.CompiledScene.FromString(blobs.path(found.scene_sha256).read_bytes())
    assert scene.tracing.direction == scene_pb2.DIRECTION_ADJOINT


def test_photons_from_luminaires_count_what_leaves_the_scene(blobs: BlobStore) -> None:
    """For example, the meter measures the rainbow of a drop in the Sun."""
    found = compile_scene(parse_document(json.dumps(_lamp("forward", **BEYOND["$.distant"]))), blobs)
    assert any("it counts where it leaves the scene" in each.sentence for each in found.warnings)


def test_a_lamp_alone_is_measured_either_way(blobs: BlobStore) -> None:
    found = compile_scene(parse_document(json.dumps(_lamp("forward"))), blobs)
    assert not found.warnings


def test_photons_from_luminaires_travel_alone_through_media(blobs: BlobStore) -> None:
    document = _lamp("forward", **FOG)
    document["surfaces"].append(
        {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 0.2}, "interior": {"media": ["fog"]}}
    )
    document["tracing"]["photons_together"] = 4
    with pytest.raises(InputError, match=r"photons_together.*expected 1, or auto"):
        compile_scene(parse_document(json.dumps(document)), blobs)
