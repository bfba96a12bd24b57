"""What moves is where it should be at every time, and groups of surfaces are shown where instances say."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.compile.placement import motion_steps
from nocturne_scene.document import bounds
from nocturne_scene.document.placement import RigidMotion
from nocturne_scene.document.read import parse_document
from nocturne_scene.errors import InputError

from .conftest import Compile

QUAD = {"type": "quad", "corner": [1, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
GREY = {"type": "lambertian", "reflectance": 0.5}


def vertices(scene: scene_pb2.CompiledScene, index: int, blobs: BlobStore) -> Any:
    """Shape (time steps, vertices, 3)."""
    mesh = scene.surfaces[index].mesh
    blob = blobs.path(mesh.blob.hex()).read_bytes()
    steps = max(1, mesh.time_steps)
    return np.frombuffer(blob, "<f4", 3 * steps * mesh.vertex_count).reshape(steps, -1, 3)


def point(vector: scene_pb2.Vector) -> list[float]:
    return [vector.x, vector.y, vector.z]


@given(
    degrees=st.floats(-360, 360),
    about=st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5)),
    axis=st.tuples(st.floats(0.1, 1), st.floats(-1, 1), st.floats(-1, 1)),
)
def test_a_turn_stays_close_to_its_arc(degrees: float, about: Any, axis: Any) -> None:
    turn = {"axis": axis, "degrees": degrees, "about": about}
    steps = motion_steps(RigidMotion.model_validate({"rotate": turn}))
    assert len(steps) <= bounds.TIME_STEPS
    unit = np.array(axis) / np.linalg.norm(axis)
    start = np.array([3.0, -2.0, 4.0])
    radial = start - about - ((start - about) @ unit) * unit
    radius = np.linalg.norm(radial)
    path = np.array([step.points(start) for step in steps])
    middles = np.concatenate([path, (path[1:] + path[:-1]) / 2]) - about
    distances = np.linalg.norm(middles - (middles @ unit)[:, None] * unit, axis=1)
    assert np.all(np.abs(distances - radius) <= radius / 3000 + 1e-9)
    if len(steps) > 1:  # the end is where Rodrigues' formula puts it
        a = math.radians(degrees)
        along = ((start - about) @ unit) * unit
        end = about + along + math.cos(a) * radial + math.sin(a) * np.cross(unit, radial)
        assert path[-1] == pytest.approx(end, abs=1e-9)


def test_a_moving_quad_is_a_mesh_and_a_moving_sphere_has_centres(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    motion = {"translate": [0, 0, 2]}
    document["surfaces"][0] |= {"motion": motion, "scale": 2}
    document["surfaces"][1] |= {"motion": motion}
    scene = compiled(document)
    sphere = scene.surfaces[0].sphere
    assert (point(sphere.centre), [point(c) for c in sphere.later_centres]) == ([0, 0, 6], [[0, 0, 8]])
    assert scene.surfaces[1].mesh.time_steps == 2
    first, second = vertices(scene, 1, blobs)
    assert first.tolist() == [[0, 3, 3], [1, 3, 3], [1, 3, 4], [0, 3, 4]]
    assert (second - first).tolist() == [[0, 0, 2]] * 4


def test_placements_come_after_the_surfaces_own(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    placements = [{}, {"scale": 2}, {"rotate": {"axis": [0, 0, 1], "degrees": 90}}]
    document["surfaces"][2] |= {"translate": [1, 0, 0], "motion": {"placements": placements}}
    found = vertices(compiled(document), 2, blobs)
    assert found[:, 1].tolist() == [[2, 0, 0], [4, 0, 0], [0, 2, 0]]


def test_a_sensor_moves_as_a_whole(document: dict[str, Any], compiled: Compile) -> None:
    document["sensor"]["motion"] = {"rotate": {"axis": [0, 1, 0], "degrees": 2}, "translate": [1, 0, 0]}
    sensor = compiled(document).sensor
    [later] = sensor.later_poses
    angle = math.radians(2)
    assert point(sensor.position) == [0, 0, -2]
    assert point(later.position) == pytest.approx([1 - 2 * math.sin(angle), 0, -2 * math.cos(angle)])
    assert point(later.forward) == pytest.approx([math.sin(angle), 0, math.cos(angle)])
    assert np.cross(point(later.right), point(later.up)) == pytest.approx(-np.array(point(later.forward)))


def with_groups(document: dict[str, Any]) -> dict[str, Any]:
    """Two leaves on a twig, two twigs on a tree, two trees."""
    leaf = {"shape": QUAD, "kernel": GREY}
    lamp = {"shape": QUAD, "kernel": GREY, "luminaire": {"radiance": 1}}
    at = [{"translate": [x, 0, 0]} for x in (0, 10)]
    document["groups"] = {
        "tree": [lamp, {"group": "twig"}, {"group": "twig", "translate": [0, 5, 0], "scale": 2}],
        "twig": [{"group": "leaf"} | place for place in at],
        "leaf": [leaf],
    }
    document["instances"] = [
        {"group": "tree"},
        {"group": "tree", "rotate": {"axis": [0, 0, 1], "degrees": 90}, "translate": [100, 0, 0]},
    ]
    return document


def test_groups_in_groups_are_flattened(document: dict[str, Any], compiled: Compile) -> None:
    scene = compiled(with_groups(document))
    assert [surface.group for surface in scene.surfaces] == [0, 0, 0, 1, 2]
    assert [luminaire.surface for luminaire in scene.luminaires] == [1, 3]
    assert [instance.group for instance in scene.instances] == [1, 2, 2, 2, 2] * 2
    matrices = [np.array(instance.transforms).reshape(3, 4) for instance in scene.instances]
    # The last leaf: 10 along its twig, doubled, 5 up the tree, turned a quarter, 100 along.
    assert matrices[-1] @ [1, 0, 0, 1] == pytest.approx([100 - 5, 20 + 2, 0])
    assert matrices[4] @ [1, 0, 0, 1] == pytest.approx([22, 5, 0])


def test_one_of_nested_instances_may_move(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    with_groups(document)["instances"][0]["motion"] = {"translate": [0, 0, 1]}
    scene = compiled(document)
    assert [len(instance.transforms) for instance in scene.instances] == [24] * 5 + [12] * 5
    document["groups"]["twig"][0]["motion"] = {"translate": [0, 0, 1]}
    assert _mistake(document, blobs).startswith("$.groups.twig[0].motion: moves inside of an instance that")


def test_unused_groups_are_told_and_left_out(document: dict[str, Any], blobs: BlobStore) -> None:
    del with_groups(document)["instances"]
    output = compile_scene(parse_document(json.dumps(document)), blobs)
    assert output.dropped == [f"$.groups.{name}: nothing uses it" for name in ("leaf", "tree", "twig")]


def test_too_many_instances_are_refused_before_they_are_made(
    document: dict[str, Any], blobs: BlobStore
) -> None:
    document["groups"] = {"g0": [{"shape": QUAD, "kernel": GREY}]}
    for level in range(1, 31):
        document["groups"][f"g{level}"] = [{"group": f"g{level - 1}"}] * 10
    document["instances"] = [{"group": "g30"}]
    assert _mistake(document, blobs).startswith(f"$.instances: {10**30} instances once")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"groups": {"a": [{"group": "b"}], "b": [{"group": "a"}]}},
            '$.groups.a: contains itself: "a" -> "b" -> "a"',
        ),
        ({"instances": [{"group": "x"}]}, '$.instances[0].group: no group named "x"'),
        ({"groups": {"a": []}}, "$.groups.a: expected at least 1"),
        ({"surfaces": []}, "$.surfaces: expected at least 1 surface"),
        (
            {"groups": {"a": [{"shape": QUAD, "kernel": "x"}]}},
            '$.groups.a[0].kernel: no kernel named "x"',
        ),
    ],
)
def test_wrong_groups_are_told(document: dict[str, Any], blobs: BlobStore, changes: Any, words: str) -> None:
    assert _mistake(document | changes, blobs).startswith(words)


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ({}, '$.surfaces[0].motion: expected an object with one of the fields "placements", "rotate"'),
        (
            {"rotate": {"axis": [0, 0, 1], "degrees": 361}},
            "$.surfaces[0].motion.rotate.degrees: must be at most 360",
        ),
        ({"placements": [{}]}, "$.surfaces[0].motion.placements: expected at least 2"),
        ({"placements": [{}] * 130}, "$.surfaces[0].motion.placements: expected at most 129"),
        ({"placements": [{}, {"scale": 2}]}, "$.surfaces[0].shape: a sphere can't change its scale"),
        ({"translate": [1e12, 0, 0]}, None),
        ({"placements": [{}, {"scale": 1e12}]}, "$.surfaces[0].shape: a sphere can't change"),
    ],
)
def test_wrong_motion_is_told(
    document: dict[str, Any], blobs: BlobStore, motion: Any, words: str | None
) -> None:
    document["surfaces"][0]["motion"] = motion
    if words is None:
        compile_scene(parse_document(json.dumps(document)), blobs)
    else:
        assert _mistake(document, blobs).startswith(words)


def _mistake(document: dict[str, Any], blobs: BlobStore) -> str:
    with pytest.raises(InputError) as caught:
        compile_scene(parse_document(json.dumps(document)), blobs)
    return str(caught.value.problems[0])
