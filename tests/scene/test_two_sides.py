"""Surfaces with a kernel on each side."""

import json
from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError

from .conftest import Compile

GREY = {"type": "lambertian", "reflectance": 0.5}


def with_kernel(document: dict[str, Any], kernel: Any) -> dict[str, Any]:
    document["surfaces"][0]["kernel"] = kernel
    return document


def test_two_sides_have_kernels_of_their_own_also_inside_a_blend(
    document: dict[str, Any], compiled: Compile
) -> None:
    sides = {"type": "two_sided", "front": GREY, "back": {"type": "conductor", "index": "Al"}}
    scene = compiled(with_kernel(document, sides))
    surface = scene.surfaces[0]
    assert scene.kernels[surface.kernel].WhichOneof("model") == "lambertian"
    assert scene.kernels[surface.back_kernel].WhichOneof("model") == "conductor"
    blend = {"type": "blend", "first": sides, "second": {"type": "null"}, "weight": 0.5}
    scene = compiled(with_kernel(document, blend))
    surface = scene.surfaces[0]

    def model(part: scene_pb2.Blend.Part) -> str | None:
        return scene.kernels[part.kernel].WhichOneof("model")

    front, back = (scene.kernels[index].blend.parts for index in (surface.kernel, surface.back_kernel))
    assert [model(part) for part in front] == ["lambertian", "null_kernel"]
    assert [model(part) for part in back] == ["conductor", "null_kernel"]
    same = {"type": "two_sided", "front": GREY, "back": GREY}
    assert not compiled(with_kernel(document, same)).surfaces[0].HasField("back_kernel")


SHEET = {"type": "diffuse_transmitter", "reflectance": 0.5, "transmittance": 0.25}


@pytest.mark.parametrize(
    ("front", "back"),
    [
        (SHEET, SHEET | {"reflectance": 0.25}),
        (SHEET | {"transmittance": 0.0}, GREY),
        (
            {"type": "mask", "kernel": GREY, "opacity": 0.5},
            {"type": "mask", "kernel": {"type": "conductor", "index": "Al"}, "opacity": 0.5},
        ),
    ],
)
def test_both_sides_may_let_the_same_light_through(
    front: dict[str, Any], back: dict[str, Any], document: dict[str, Any], compiled: Compile
) -> None:
    scene = compiled(with_kernel(document, {"type": "two_sided", "front": front, "back": back}))
    assert scene.surfaces[0].HasField("back_kernel")


@pytest.mark.parametrize(
    "back", [SHEET | {"transmittance": 0.5}, GREY, {"type": "null"}, {"type": "thin_pane", "index": 1.5}]
)
def test_light_cannot_go_through_in_one_direction_only(
    back: dict[str, Any], document: dict[str, Any], blobs: BlobStore
) -> None:
    sides = {"type": "two_sided", "front": SHEET, "back": back}
    with pytest.raises(InputError) as caught:
        compile_scene(parse_document(json.dumps(with_kernel(document, sides))), blobs)
    [problem] = map(str, caught.value.problems)
    assert problem.startswith("$.surfaces[0].kernel: lets other light through from its front")
