"""Compiled scenes hold what the document uses and nothing else, and equal documents give equal bytes."""

import copy
import hashlib
import json
import math
import random
import struct
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document, parse_document
from nocturne_scene.errors import InputError

from .conftest import Compile, files_in

PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)


def as_array(vector: scene_pb2.Vector) -> Any:
    return np.array([vector.x, vector.y, vector.z])


def test_references_are_resolved_and_shared(document: dict[str, Any], compiled: Compile) -> None:
    document["spectra"]["again"] = copy.deepcopy(document["spectra"]["white"])
    document["surfaces"][2]["kernel"] = {"type": "lambertian", "reflectance": "again"}
    scene = compiled(document)
    assert [surface.kernel for surface in scene.surfaces] == [0, 1, 0]
    assert [kernel.lambertian.reflectance.spectrum for kernel in scene.kernels] == [0, 1]
    [luminaire] = scene.luminaires
    assert (luminaire.surface, luminaire.radiance.spectrum, luminaire.two_sided) == (1, 2, False)
    assert len(scene.spectra) == 3
    assert scene.spectra[0].step_nm == 100
    assert list(scene.spectra[1].values) == [0.5]
    assert scene.spectra[2].zero_outside


def test_what_is_not_used_is_dropped_and_told(document: dict[str, Any], blobs: BlobStore) -> None:
    document["spectra"]["spare"] = {"blackbody": 4000}
    document["kernels"]["spare"] = {"type": "lambertian", "reflectance": 0.9}
    document["surfaces"][2]["shape"]["triangles"].append([0, 0, 1])
    document["surfaces"][0]["luminaire"] = {"radiance": 0}
    output = compile_scene(check_document(document), blobs)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    assert (len(scene.spectra), len(scene.kernels), len(scene.luminaires)) == (4, 3, 1)
    assert output.dropped == [
        "$.surfaces[0].luminaire: emits no visible light",
        "$.surfaces[2].shape: 1 triangles without an area",
        "$.spectra.spare: nothing uses it",
        "$.kernels.spare: nothing uses it",
    ]


@pytest.mark.parametrize(
    "kernel",
    [
        {"type": "null"},
        "clear",
        {"type": "mask", "kernel": {"type": "lambertian", "reflectance": 0.5}, "opacity": 0},
    ],
)
def test_a_surface_that_all_light_passes_is_dropped_and_told(
    kernel: object, document: dict[str, Any], blobs: BlobStore
) -> None:
    """The scene is that without it, to the byte, also where others come after it."""
    plain = compile_scene(check_document(document), blobs)
    ball = {"shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1}, "kernel": kernel}
    document["kernels"]["clear"] = {"type": "null"}
    document["surfaces"].insert(1, ball)
    output = compile_scene(check_document(document), blobs)
    assert output.scene_sha256 == plain.scene_sha256
    assert "$.surfaces[1]: all light passes it, and it emits none" in output.dropped


def test_a_surface_that_all_light_passes_stays_where_it_does_something(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    """It emits, bounds a medium, or is there by half."""
    sphere = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}
    nothing = {"type": "null"}
    grey = {"type": "lambertian", "reflectance": 0.5}
    document["media"] = {"fog": {"absorption": 1}}
    document["surfaces"] += [
        {"shape": sphere, "kernel": nothing, "luminaire": {"radiance": 1}},
        {"shape": sphere, "interior": {"media": ["fog"]}},
        {"shape": sphere, "kernel": {"type": "mask", "kernel": grey, "opacity": 0.5}},
    ]
    output = compile_scene(check_document(document), blobs)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    assert len(scene.surfaces) == len(document["surfaces"])


def test_a_scene_keeps_a_surface(document: dict[str, Any], blobs: BlobStore) -> None:
    sphere = {"type": "sphere", "centre": [0, 0, 0], "radius": 1}
    document["surfaces"] = [{"shape": sphere, "kernel": {"type": "null"}}] * 2
    document["environment"] = {"radiance": 1}
    output = compile_scene(check_document(document), blobs)
    scene = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    assert len(scene.surfaces) == 1


def test_a_motion_that_moves_nothing_is_dropped_and_told(document: dict[str, Any], blobs: BlobStore) -> None:
    """Surface and sensor: the scene is that without the motions, to the byte."""
    still = compile_scene(check_document(document), blobs)
    there = {"translate": [0, 0, 0], "rotate": {"axis": [0, 1, 0], "degrees": 0}}
    document["surfaces"][0]["motion"] = {"placements": [there, there, there]}
    document["surfaces"][1]["motion"] = {"rotate": {"axis": [0, 1, 0], "degrees": 0}}
    document["sensor"]["motion"] = {"translate": [0, 0, 0]}
    output = compile_scene(check_document(document), blobs)
    assert output.scene_sha256 == still.scene_sha256
    assert output.dropped == [
        "$.sensor.motion: moves nothing",
        "$.surfaces[0].motion: moves nothing",
        "$.surfaces[1].motion: moves nothing",
        *still.dropped,
    ]


@pytest.mark.parametrize(
    ("table", "values"),
    [
        ([[300, 2], [900, 2]], 1),
        ([[360, 2], [830, 2]], 1),
        ([[400, 2], [700, 2]], 4),
        ([[360, 2], [460, 2], [860, 1]], 6),
    ],
)
def test_a_table_that_is_constant_is_a_number(
    table: list[list[float]], values: int, document: dict[str, Any], compiled: Compile
) -> None:
    """Radiance is zero beyond its table, so a table that ends within the visible range is none."""
    document["spectra"] = {"white": 0.5, "red": 0.5}
    document["surfaces"][1]["luminaire"] = {"radiance": {"table": table}}
    scene = compiled(document)
    spectrum = scene.spectra[scene.luminaires[0].radiance.spectrum]
    assert len(spectrum.values) == values
    assert spectrum.values[0] == 2


def test_the_mixture_is_scaled_to_one(document: dict[str, Any], compiled: Compile) -> None:
    document["tracing"] = {"mixture": {"kernel": 1, "luminaires": 2, "uniform": 1}, "seed": 2**64 - 1}
    tracing = compiled(document).tracing
    assert (tracing.weight_kernel, tracing.weight_luminaires, tracing.weight_uniform) == (0.25, 0.5, 0.25)
    assert (tracing.h, tracing.roulette_after, tracing.maximum_depth) == (4, 2, 0)
    assert tracing.seed == 2**64 - 1
    assert tracing.sequence == scene_pb2.SAMPLE_SEQUENCE_SOBOL


def test_a_black_scene_samples_no_luminaires(document: dict[str, Any], compiled: Compile) -> None:
    document["spectra"] = {"white": 0, "red": 0}
    document["surfaces"][1]["kernel"]["reflectance"] = 0
    tracing = compiled(document).tracing
    assert (tracing.weight_kernel, tracing.weight_luminaires, tracing.weight_uniform) == (1, 0, 0)


def test_the_sensor_has_an_orthonormal_frame(document: dict[str, Any], compiled: Compile) -> None:
    document["sensor"] = {
        "type": "thin_lens",
        "position": [1, 2, 3],
        "look_at": [-4, 1, 7],
        "up": [0.1, 3, 0.2],
        "vertical_field_of_view_degrees": 90,
        "lens_radius": 0.01,
        "focus_distance": 4,
        "wavelengths": "uniform",
    }
    sensor = compiled(document).sensor
    right, up, forward = as_array(sensor.right), as_array(sensor.up), as_array(sensor.forward)
    frame = np.stack([right, up, forward])
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.cross(right, up) == pytest.approx(-forward)
    assert forward == pytest.approx(np.array([-5, -1, 4]) / math.sqrt(42))
    assert up @ [0.1, 3, 0.2] > 0
    assert sensor.vertical_field_of_view == pytest.approx(math.pi / 2)
    assert (sensor.lens_radius, sensor.focus_distance) == (0.01, 4)
    assert sensor.wavelength_sampling == scene_pb2.WAVELENGTH_SAMPLING_UNIFORM
    assert (sensor.response_first_nm, sensor.response_step_nm, len(sensor.response_y)) == (360, 1, 471)


def test_shapes_are_scaled_then_rotated_then_shifted(document: dict[str, Any], compiled: Compile) -> None:
    where = {"scale": 2, "rotate": {"axis": [0, 0, 5], "degrees": 90}, "translate": [10, 0, 0]}
    for surface in document["surfaces"]:
        surface.update(where)
    sphere, quad, mesh = (surface for surface in compiled(document).surfaces)
    assert as_array(sphere.sphere.centre).tolist() == [10, 0, 6]
    assert sphere.sphere.radius == 2
    assert as_array(quad.quad.corner).tolist() == [4, 0, 6]
    assert as_array(quad.quad.edge_u).tolist() == [0, 2, 0]
    assert as_array(quad.quad.edge_v).tolist() == [0, 0, 2]
    assert mesh.mesh.vertex_count == 4


def test_a_mesh_blob_holds_vertices_then_indices(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["surfaces"][2]["translate"] = [0, 0, 1]
    mesh = compiled(document).surfaces[2].mesh
    blob = blobs.path(mesh.blob.hex()).read_bytes()
    assert hashlib.sha256(blob).digest() == mesh.blob
    assert (mesh.vertex_count, mesh.triangle_count) == (4, 2)
    assert blob == struct.pack("<12f6I", 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 0, 1, 2, 1, 3, 2)


def test_an_asset_is_compiled_like_the_same_inline_mesh(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["surfaces"][2]["shape"]["triangles"] = [[0, 1, 2]]
    inline = compiled(document)
    document["surfaces"][2]["shape"] = {"type": "mesh", "asset": f"sha256:{blobs.put(PLY)}", "format": "ply"}
    assert compiled(document) == inline


def shuffled(value: Any, order: random.Random) -> Any:
    """The same JSON with the keys of all objects in another order."""
    if isinstance(value, dict):
        return {key: shuffled(value[key], order) for key in order.sample(list(value), len(value))}
    if isinstance(value, list):
        return [shuffled(item, order) for item in value]
    return value


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.randoms(use_true_random=False))
def test_the_order_of_keys_makes_no_difference(document: dict[str, Any], order: random.Random) -> None:
    with tempfile.TemporaryDirectory() as folder:
        blobs = BlobStore(Path(folder))
        again = parse_document(json.dumps(shuffled(document, order)))
        one = compile_scene(parse_document(json.dumps(document)), blobs)
        assert compile_scene(again, blobs).scene_sha256 == one.scene_sha256


def missing_asset(blobs: BlobStore) -> dict[str, Any]:
    del blobs
    return {"type": "mesh", "asset": "sha256:" + 64 * "0", "format": "ply"}


def asset_of(data: bytes, blobs: BlobStore) -> dict[str, Any]:
    return {"type": "mesh", "asset": f"sha256:{blobs.put(data)}", "format": "ply"}


@pytest.mark.parametrize(
    ("shape", "place", "words"),
    [
        (missing_asset, "$.surfaces[3].shape.asset", "upload it first"),
        (
            lambda _: {"type": "mesh", "asset": "a.ply"},
            "$.surfaces[3].shape.asset",
            "the service has no paths",
        ),
        (lambda blobs: asset_of(b"x", blobs), "$.surfaces[3].shape.asset", "not a PLY file"),
        (
            lambda blobs: asset_of(PLY.replace(b"1 0 0", b"nan 0 0"), blobs),
            "$.surfaces[3].shape.asset",
            "vertex 1",
        ),
        (
            lambda blobs: asset_of(PLY.replace(b"3 0 1 2", b"3 0 1 9"), blobs),
            "$.surfaces[3].shape.asset",
            "vertex 9",
        ),
        (
            lambda _: {
                "type": "mesh",
                "vertices": [[0, 0, 0], [1, 0, 0], [1e12, 9, 0]],
                "triangles": [[0, 1, 2]],
            },
            "$.surfaces[3].shape.vertices[2]",
            "farther than",
        ),
        (
            lambda _: {
                "type": "mesh",
                "vertices": [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
                "triangles": [[0, 1, 2]],
            },
            "$.surfaces[3].shape",
            "no triangle with an area",
        ),
        (
            lambda _: {
                "type": "mesh",
                "vertices": [[0, 0, 0], [2e-8, 0, 0], [0, 2e-8, 0]],
                "triangles": [[0, 1, 2]],
            },
            "$.surfaces[3].shape",
            "is 5.65685e-08 m large once scaled; expected at least 1e-07 m",
        ),
        (
            lambda _: {"type": "sphere", "centre": [0, 0, 0], "radius": 4e-8},
            "$.surfaces[3].shape.radius",
            "is 8e-08 m long once scaled; expected 1e-07",
        ),
        (
            lambda _: {"type": "quad", "corner": [0, 0, 0], "edge_u": [1e-9, 0, 0], "edge_v": [0, 1, 0]},
            "$.surfaces[3].shape.edge_u",
            "is 2e-09 m long once scaled",
        ),
        (
            lambda _: {"type": "sphere", "centre": [0, 0, 0], "radius": 1e12},
            "$.surfaces[3].shape.radius",
            "scaled",
        ),
        (
            lambda _: {"type": "sphere", "centre": [1e12, 0, 0], "radius": 1},
            "$.surfaces[3].shape.centre",
            "placed",
        ),
        (
            lambda _: {"type": "quad", "corner": [0, 0, 0], "edge_u": [1e12, 0, 0], "edge_v": [0, 1, 0]},
            "$.surfaces[3].shape.edge_u",
            "scaled",
        ),
    ],
)
def test_what_can_not_be_compiled_is_told_and_leaves_nothing_behind(
    document: dict[str, Any], blobs: BlobStore, tmp_path: Path, shape: Any, place: str, words: str
) -> None:
    document["surfaces"].append({"shape": shape(blobs), "kernel": "white", "scale": 2})
    before = files_in(tmp_path)
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(document), blobs)
    [problem] = caught.value.problems
    assert problem.place == place
    assert words in problem.message
    assert files_in(tmp_path) == before


def test_a_scene_whose_luminaires_are_dark_is_refused(document: dict[str, Any], blobs: BlobStore) -> None:
    document["surfaces"][1]["luminaire"]["radiance"] = {"table": [[900, 1], [1000, 1]]}
    with pytest.raises(InputError, match=r"\$\.surfaces: no luminaire emits visible light"):
        compile_scene(check_document(document), blobs)
