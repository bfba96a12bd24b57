"""Scenes far from the origin compile to the same message as near it."""

import copy
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document

from .conftest import Compile, Document

GREY = {"type": "lambertian", "reflectance": 0.5}
QUAD = {"type": "quad", "corner": [1, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
MESH = {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}


def everything() -> Document:
    """All that has a place. Coordinates are dyadic, so that they can be moved without rounding."""
    layers = {"layers": [[0.0, 1.0], [2.0, 0.0]]}
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0.5, 0.25, -2],
            "look_at": [0.5, 0.25, 1],
            "vertical_field_of_view_degrees": 40,
            "motion": {"translate": [0.5, 0, 0]},
        },
        "media": {
            "haze": {
                "absorption": 1.0,
                "density": {**layers, "above": {"point": [0, 0.5, 0], "up": [0, 1, 0]}},
            },
            "air": {"absorption": 1.0, "density": {**layers, "above": {"centre": [0, -64, 0], "radius": 64}}},
        },
        "unbounded_media": ["haze", "air"],
        "surfaces": [
            {"shape": QUAD, "kernel": GREY, "luminaire": {"radiance": 1.0}},
            {"shape": {"type": "sphere", "centre": [0, 0, 3], "radius": 1}, "kernel": GREY},
            {
                "shape": {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]},
                "kernel": GREY,
                "rotate": {"axis": [0, 0, 1], "degrees": 90},
                "translate": [2, 0.5, 0],
            },
            {"shape": MESH, "kernel": GREY, "motion": {"translate": [0, 0.25, 0]}},
        ],
        "groups": {"leaf": [{"shape": QUAD, "kernel": GREY}]},
        "instances": [{"group": "leaf", "translate": [4, 0, 0]}],
        "important_directions": [{"shape": QUAD, "translate": [0, 1, 0]}],
    }


def moved(document: Document, by: list[float]) -> Document:
    """The same scene elsewhere, moved by each kind of placement in a document."""

    def add(point: list[float]) -> list[float]:
        return [a + b for a, b in zip(point, by, strict=True)]

    document = copy.deepcopy(document)
    for key in ("position", "look_at"):
        document["sensor"][key] = add(document["sensor"][key])
    above = [medium["density"]["above"] for medium in document["media"].values()]
    above[0]["point"], above[1]["centre"] = add(above[0]["point"]), add(above[1]["centre"])
    for each in document["surfaces"] + document["instances"] + document["important_directions"]:
        each["translate"] = add(each.get("translate", [0, 0, 0]))
    return document


def test_what_is_far_out_compiles_to_what_it_is_near_the_origin(compiled: Compile) -> None:
    near = compiled(everything())
    assert compiled(moved(everything(), [1024.0 * 7, -1024.0 * 977, 1024.0 * 9765])) == near


_FAR = st.floats(-1e7, 1e7)


@settings(max_examples=20)
@given(x=st.floats(1e4, 1e7), y=_FAR, z=_FAR)
def test_the_sensor_is_near_the_origin_wherever_the_scene_is(x: float, y: float, z: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        blobs = BlobStore(Path(folder))
        sha256 = compile_scene(check_document(moved(everything(), [x, y, z])), blobs).scene_sha256
        scene = scene_pb2.CompiledScene.FromString(blobs.path(sha256).read_bytes())
    sensor, corner = scene.sensor.position, scene.surfaces[0].quad.corner
    apart = (corner.x - sensor.x, corner.y - sensor.y, corner.z - sensor.z)
    assert apart == pytest.approx((0.5, -0.25, 2.0), abs=1e-8)
    assert max(abs(sensor.x), abs(sensor.y), abs(sensor.z)) <= 512.0


def test_a_sensor_that_looks_from_afar_leaves_the_scene_where_it_is(
    document: Document, compiled: Compile
) -> None:
    document["sensor"]["position"] = [0, 0, -20_000]
    scene = compiled(document)
    assert scene.sensor.position.z == -20_000
    assert scene.surfaces[0].sphere.centre.z == 3


def test_a_mesh_whose_own_coordinates_are_far_out(document: Document, compiled: Compile) -> None:
    """A mesh from a map: its file has large numbers, and the camera stands next to it."""
    [*_, surface] = document["surfaces"]
    document |= {"surfaces": [surface], "environment": {"radiance": 1.0}}
    near = compiled(document).surfaces[0].mesh
    by = [1024.0 * 4882, 0.0, -1024.0 * 488]
    mesh = surface["shape"]
    mesh["vertices"] = [[a + b for a, b in zip(v, by, strict=True)] for v in mesh["vertices"]]
    document["sensor"] |= {"position": [by[0], 0, by[2] - 2], "look_at": by}
    assert compiled(document).surfaces[0].mesh == near


def test_what_is_far_away_has_fine_numbers(compiled: Compile) -> None:
    """A pane of a tenth of a micrometre, 100 km from the sensor and from the document's origin."""
    pane = {"type": "box", "minimum": [-1, -1, 100_000.0], "maximum": [1, 1, 100_000.0 + 1e-7]}
    scene = compiled(
        {
            "nocturne": 1,
            "sensor": {
                "type": "pinhole",
                "position": [0, 0, 0],
                "look_at": [0, 0, 1],
                "vertical_field_of_view_degrees": 1,
            },
            "surfaces": [{"shape": pane, "kernel": {"type": "dielectric", "index": 1.5}}],
            "environment": {"radiance": 1.0},
        }
    )
    assert scene.sensor.position.z == pytest.approx(-100_000.0, abs=1.0)
