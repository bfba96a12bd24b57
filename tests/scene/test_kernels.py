"""Kernels are resolved, flattened and separated by side; errors are reported with their places."""

import json
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document, parse_document
from nocturne_scene.errors import InputError
from nocturne_scene.spectra import indices

from .conftest import Compile

GLASS = {"type": "dielectric", "index": "N-BK7"}
GREY = {"type": "lambertian", "reflectance": 0.5}


def with_kernel(document: dict[str, Any], kernel: Any) -> dict[str, Any]:
    document["surfaces"][0]["kernel"] = kernel
    return document


def kernel_of(scene: scene_pb2.CompiledScene) -> scene_pb2.Kernel:
    return scene.kernels[scene.surfaces[0].kernel]


def leaf(scene: scene_pb2.CompiledScene, part: scene_pb2.Blend.Part) -> str | None:
    return scene.kernels[part.kernel].WhichOneof("model")


@pytest.mark.parametrize(("distribution", "beckmann"), [(None, False), ("ggx", False), ("beckmann", True)])
def test_facets_are_of_ggx_or_beckmann(
    document: dict[str, Any], compiled: Compile, distribution: str | None, beckmann: bool
) -> None:
    kernel = {**GLASS, "roughness": 0.2} | ({} if distribution is None else {"distribution": distribution})
    assert kernel_of(compiled(with_kernel(document, kernel))).dielectric.roughness.beckmann == beckmann


def test_a_metal_has_its_measured_index(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(with_kernel(document, {"type": "conductor", "index": "Au", "roughness": 0.2}))
    gold = kernel_of(scene).conductor
    found = indices.metal("Au")
    at = np.array([450.0, 632.8])
    # Tables are 0.5 nm apart and float32.
    assert spectra.evaluate(scene.spectra[gold.n], at) == pytest.approx(found.n(at), rel=1e-3)
    assert spectra.evaluate(scene.spectra[gold.k], at) == pytest.approx(found.k(at), rel=1e-3)
    assert (gold.roughness.alpha_u.constant, gold.roughness.alpha_v.constant) == (0.2, 0.2)


def test_a_principled_surface_has_its_defaults(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(with_kernel(document, {"type": "principled", "base": 0.4, "metallic": 0.25, "coat": 1}))
    found = kernel_of(scene).principled
    numbers = (found.metallic, found.roughness, found.coat, found.coat_roughness)
    assert [each.constant for each in numbers] == [0.25, 0.5, 1.0, 0.0]
    assert found.coat_index == 1.5
    assert list(scene.spectra[found.base.spectrum].values) == pytest.approx([0.4])
    assert list(scene.spectra[found.index].values) == pytest.approx([1.5])
    assert not any(found.HasField(name) for name in ("reflectance", "brush", "sheen"))


def test_a_principled_surface_has_what_is_asked_for(document: dict[str, Any], compiled: Compile) -> None:
    kernel = {
        "type": "principled",
        "base": 0.4,
        "specular": 0.5,
        "specular_colour": 0.2,
        "roughness": 0.1,
        "roughness_across": 0.3,
        "rotation": 0.25,
        "sheen": 0.6,
        "sheen_roughness": 0.7,
    }
    scene = compiled(with_kernel(document, kernel))
    found = kernel_of(scene).principled
    numbers = (found.reflectance.amount, found.brush.roughness, found.brush.rotation, found.sheen.roughness)
    assert [each.constant for each in numbers] == [0.5, 0.3, 0.25, 0.7]
    assert list(scene.spectra[found.reflectance.normal.spectrum].values) == pytest.approx([0.2])
    assert list(scene.spectra[found.sheen.colour.spectrum].values) == pytest.approx([0.6])


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("base", 1.5),
        ("metallic", -0.1),
        ("roughness", 2),
        ("index", 0.0),
        ("coat_index", 5),
        ("specular", 2),
        ("specular_colour", 1.5),
        ("roughness_across", 2),
        ("sheen", -1),
    ],
)
def test_mistakes_of_a_principled_surface_are_told(
    document: dict[str, Any], compiled: Compile, field: str, value: float
) -> None:
    kernel = {"type": "principled", "base": 0.4} | {field: value}
    with pytest.raises(InputError) as caught:
        compiled(with_kernel(document, kernel))
    assert f"$.surfaces[0].kernel.{field}" in str(caught.value)


def test_a_metal_can_be_given_in_numbers(document: dict[str, Any], compiled: Compile) -> None:
    index = {"n": 0.18344, "k": {"table": [[500, 3], [600, 4]]}}
    scene = compiled(with_kernel(document, {"type": "conductor", "index": index}))
    metal = kernel_of(scene).conductor
    assert list(scene.spectra[metal.n].values) == pytest.approx([0.18344])
    assert spectra.evaluate(scene.spectra[metal.k], np.array([400.0, 550.0])) == pytest.approx([3, 3.5])


@pytest.mark.parametrize(
    ("index", "at_d"),
    [
        (1.5, 1.5),
        ("N-BK7", 1.5168),  # Schott's data sheet, at 587.5618 nm
        (
            {
                "sellmeier": {
                    "b": [1.03961212, 0.231792344, 1.01046945],
                    "c": [0.00600069867, 0.0200179144, 103.560653],
                }
            },
            1.5168,
        ),
        ({"cauchy": [1.5046, 0.0042]}, 1.5046 + 0.0042 / 0.5875618**2),
        ({"table": [[500, 1.5], [600, 1.6]]}, 1.5875618),
    ],
)
def test_an_index_is_a_name_a_number_a_formula_or_a_table(
    document: dict[str, Any], compiled: Compile, index: Any, at_d: float
) -> None:
    scene = compiled(with_kernel(document, {"type": "dielectric", "index": index}))
    interior = scene.interiors[scene.surfaces[0].interior]
    found = spectra.evaluate(scene.spectra[interior.index], np.array([587.5618]))
    assert found == pytest.approx([at_d], abs=1e-5)


def test_equal_bodies_share_an_interior(document: dict[str, Any], compiled: Compile) -> None:
    document["kernels"]["glass"] = GLASS | {"absorption": {"table": [[400, 2], [700, 3]]}, "priority": 3}
    for index, kernel in enumerate(("glass", document["kernels"]["glass"], GLASS)):
        document["surfaces"][index]["kernel"] = kernel
    scene = compiled(document)
    assert [surface.interior for surface in scene.surfaces] == [0, 0, 1]
    assert [kernel.WhichOneof("model") for kernel in scene.kernels] == ["dielectric"]
    first, second = scene.interiors
    assert first.priority == 3
    assert spectra.evaluate(scene.spectra[first.absorption], np.array([550.0])) == pytest.approx([2.5])
    assert not second.HasField("absorption")
    assert not compiled(with_kernel(document, GREY)).surfaces[0].HasField("interior")


def test_blends_and_masks_become_one_sum(document: dict[str, Any], compiled: Compile) -> None:
    document["kernels"]["inner"] = {
        "type": "blend",
        "first": GREY,
        "second": {"type": "conductor", "index": "Ag"},
        "weight": 0.25,
    }
    scene = compiled(with_kernel(document, {"type": "mask", "kernel": "inner", "opacity": 0.75}))
    parts = kernel_of(scene).blend.parts
    assert [leaf(scene, part) for part in parts] == ["lambertian", "conductor", "null_kernel"]
    weights = [
        np.prod([1 - f.weight.constant if f.complement else f.weight.constant for f in part.factors])
        for part in parts
    ]
    assert weights == pytest.approx([0.75 * 0.75, 0.75 * 0.25, 0.25])


@pytest.mark.parametrize(("weight", "model"), [(0, "lambertian"), (1, "dielectric")])
def test_a_blend_with_all_weight_on_one_side_is_that_kernel(
    document: dict[str, Any], compiled: Compile, weight: float, model: str
) -> None:
    blend = {"type": "blend", "first": GREY, "second": GLASS, "weight": weight}
    scene = compiled(with_kernel(document, blend))
    assert kernel_of(scene).WhichOneof("model") == model
    assert scene.surfaces[0].HasField("interior") == (weight == 1)


def nested(depth: int) -> dict[str, Any]:
    kernel: dict[str, Any] = GREY
    for _ in range(depth - 1):
        kernel = {"type": "mask", "kernel": kernel, "opacity": 0.5}
    return kernel


def wide(levels: int) -> dict[str, Any]:
    if levels == 0:
        return GREY
    inner = wide(levels - 1)
    return {"type": "blend", "first": inner, "second": inner, "weight": 0.5}


def test_blends_may_have_eight_parts(document: dict[str, Any], compiled: Compile) -> None:
    assert len(kernel_of(compiled(with_kernel(document, wide(3)))).blend.parts) == 8
    assert compiled(with_kernel(document, nested(8)))


def mistakes(document: dict[str, Any], blobs: BlobStore) -> list[str]:
    with pytest.raises(InputError) as caught:
        compile_scene(parse_document(json.dumps(document)), blobs)
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("kernel", "place", "words"),
    [
        (wide(4), "$.surfaces[0].kernel", "blends 16 kernels"),
        (nested(9), "$.surfaces[0].kernel", "9 deep, names followed; at most 8"),
        ({"type": "two_sided", "front": GREY, "back": GLASS}, "$.surfaces[0].kernel.back", "has both sides"),
        (
            {"type": "blend", "first": GLASS, "second": GLASS | {"priority": 1}, "weight": 0.5},
            "$.surfaces[0].kernel",
            "dielectrics of different bodies",
        ),
        (GLASS | {"index": "N-BK8"}, "$.surfaces[0].kernel.index", 'expected one of "'),
        (GLASS | {"index": "Au"}, "$.surfaces[0].kernel.index", "that is a metal"),
        ({"type": "conductor", "index": "water"}, "$.surfaces[0].kernel.index", '"Au"'),
        ({"type": "conductor", "index": {"n": 1.0}}, "$.surfaces[0].kernel.index.k", "missing"),
        (GLASS | {"index": 0}, "$.surfaces[0].kernel.index", "at least 0.001"),
        (GLASS | {"index": {"cauchy": [-1.0]}}, "$.surfaces[0].kernel.index", "is -1 at 360 nm"),
        (
            GLASS | {"index": {"table": [[500, 1.5], [400, 1.5]]}},
            "$.surfaces[0].kernel.index.table[1][0]",
            "must increase",
        ),
        (GLASS | {"absorption": {"blackbody": 3000}}, "$.surfaces[0].kernel.absorption", "in 1/m"),
        (GLASS | {"roughness": 1.5}, "$.surfaces[0].kernel.roughness", "at most 1"),
        (GLASS | {"roughness_u": 0.5}, "$.surfaces[0].kernel.roughness_v", "go together"),
        (
            {
                "type": "diffuse_transmitter",
                "reflectance": 0.6,
                "transmittance": {"table": [[500, 0.2], [600, 0.5]]},
            },
            "$.surfaces[0].kernel.transmittance",
            "add up to 1.1 at 600 nm",
        ),
        (
            {"type": "thin_pane", "index": 1.5, "transmittance": 2},
            "$.surfaces[0].kernel.transmittance",
            "[0, 1]",
        ),
        (
            {"type": "phong", "reflectance": {"lines": [{"nm": 500, "power": 1}]}, "exponent": 5},
            "$.surfaces[0].kernel.reflectance",
            "a radiance",
        ),
        (
            {"type": "measured", "asset": "a.binary", "format": "merl"},
            "$.surfaces[0].kernel.asset",
            "no paths",
        ),
        (
            {"type": "lambertian", "reflectance": {"rgb": [0, 1, 2]}},
            "$.surfaces[0].kernel.reflectance.rgb[2]",
            "at most 1",
        ),
        (
            {"type": "blend", "first": "wite", "second": GREY, "weight": 1},
            "$.surfaces[0].kernel.first",
            "no kernel named",
        ),
    ],
)
def test_a_wrong_kernel_is_told(
    document: dict[str, Any], blobs: BlobStore, kernel: Any, place: str, words: str
) -> None:
    [problem, *_] = mistakes(with_kernel(document, kernel), blobs)
    assert problem.startswith(f"{place}: ")
    assert words in problem


def test_kernels_that_contain_themselves_are_named(document: dict[str, Any], blobs: BlobStore) -> None:
    document["kernels"] |= {
        "a": {"type": "mask", "kernel": "b", "opacity": 0.5},
        "b": {
            "type": "blend",
            "first": "white",
            "second": {"type": "mask", "kernel": "a", "opacity": 1},
            "weight": 0.5,
        },
    }
    assert mistakes(document, blobs) == ['$.kernels.a: contains itself: "a" -> "b" -> "a"']


def test_a_mistake_in_a_named_kernel_is_told_once_and_there(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    document["kernels"]["bad"] = GLASS | {"index": {"cauchy": [-1.0]}}
    for surface in document["surfaces"]:
        surface["kernel"] = "bad"
    [problem] = mistakes(document, blobs)
    assert problem.startswith("$.kernels.bad.index: ")


def test_a_long_chain_of_names_is_told_and_not_followed(document: dict[str, Any]) -> None:
    for number in range(5000):
        document["kernels"][f"k{number}"] = {"type": "mask", "kernel": f"k{number + 1}", "opacity": 0.5}
    document["kernels"]["k5000"] = GREY
    with pytest.raises(InputError, match="deep, names followed"):
        check_document(document)


def test_named_kernels_that_share_others_take_no_time(document: dict[str, Any]) -> None:
    for number in range(2000):
        inner = f"k{number + 1}"
        document["kernels"][f"k{number}"] = {"type": "blend", "first": inner, "second": inner, "weight": 0.5}
    document["kernels"]["k2000"] = GREY
    with pytest.raises(InputError, match="deep, names followed"):
        check_document(document)
