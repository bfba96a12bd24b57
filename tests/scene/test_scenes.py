"""The scenes of the repository compile, and the Cornell box is the measured one."""

import json
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import parse_document

from .conftest import Compile

SCENES = Path(__file__).parents[2] / "examples"


def read(name: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((SCENES / name / "scene.json").read_text("utf-8"))
    return document


def test_the_cornell_box_is_compiled_in_metres(compiled: Compile, blobs: BlobStore) -> None:
    scene = compiled(read("cornell"))
    assert len(scene.surfaces) == 8
    assert [surface.mesh.triangle_count for surface in scene.surfaces] == [2, 2, 4, 2, 2, 2, 12, 12]
    assert (len(scene.kernels), len(scene.spectra)) == (4, 5)
    luminaire = scene.surfaces[scene.luminaires[0].surface].mesh
    vertices = np.frombuffer(blobs.path(luminaire.blob.hex()).read_bytes(), "<f4", 12).reshape(-1, 3)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.13, 0, 0.105], abs=1e-6)
    first, second, third = vertices[:3]
    assert np.cross(second - first, third - first)[1] < 0  # it shines down
    assert scene.sensor.position.z == -0.8
    assert scene.sensor.forward.z == 1
    assert scene.sensor.vertical_field_of_view == pytest.approx(2 * np.arctan(12.5 / 35), rel=1e-5)


def test_the_cornell_box_has_the_measured_spectra(compiled: Compile) -> None:
    scene = compiled(read("cornell"))
    emission = scene.spectra[scene.luminaires[0].radiance.spectrum]
    at = np.array([399.0, 400.0, 450.0, 500.0, 600.0, 700.0, 701.0])
    assert spectra.evaluate(emission, at) == pytest.approx([0, 0, 4, 8, 15.6, 18.4, 0], rel=1e-6)
    red = scene.spectra[scene.kernels[scene.surfaces[5].kernel].lambertian.reflectance.spectrum]
    assert (red.first_nm, red.step_nm, len(red.values)) == (400, 4, 76)
    assert spectra.evaluate(red, np.array([600.0, 656.0, 800.0])) == pytest.approx([0.287, 0.65, 0.642])


def test_the_bumpy_spheres_are_a_million_triangles_and_the_same_each_time(
    compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    script = runpy.run_path(str(SCENES / "bumpy_spheres" / "make_mesh.py"))
    script["main"](tmp_path)
    document = read("bumpy_spheres")
    parse_document(json.dumps(document))  # as a person has it: with paths
    for surface in document["surfaces"]:
        if "asset" in surface["shape"]:
            data = (tmp_path / surface["shape"]["asset"]).read_bytes()
            surface["shape"] |= {"asset": f"sha256:{blobs.put(data)}", "format": "ply"}
    scene = compiled(document)
    assert sum(surface.mesh.triangle_count for surface in scene.surfaces) == 1_008_000
    assert len(scene.luminaires) == 2
    written = {path.name: path.read_bytes() for path in tmp_path.glob("*.ply")}
    script["main"](tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.glob("*.ply")} == written


def test_a_bumpy_sphere_is_closed_and_faces_outwards() -> None:
    script = runpy.run_path(str(SCENES / "bumpy_spheres" / "make_mesh.py"))
    indices, vertices = script["sphere_indices"](), script["sphere_vertices"](7)
    edges = np.concatenate([indices[:, [0, 1]], indices[:, [1, 2]], indices[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}
    a, b, c = vertices[indices].swapaxes(0, 1)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(4 / 3 * np.pi * 0.1**3, rel=0.3)


@pytest.mark.parametrize("name", ["colour_chart", "mixtures", "prism", "reflector"])
def test_every_scene_uses_all_that_it_holds(name: str, blobs: BlobStore) -> None:
    output = compile_scene(parse_document((SCENES / name / "scene.json").read_bytes()), blobs)
    assert output.dropped == []


def test_the_camera_sees_the_lamps_of_the_mixtures_in_every_plate() -> None:
    document = read("mixtures")
    eye = np.array(document["sensor"]["position"], dtype=float)
    shapes = {each["name"]: each["shape"] for each in document["surfaces"]}
    largest = shapes["lamp of 0.9 m"]
    for number in (1, 2, 3, 4):
        shape = shapes[f"plate {number}"]
        corner, u, v = (np.array(shape[name], dtype=float) for name in ("corner", "edge_u", "edge_v"))
        middle = corner + (u + v) / 2
        normal = np.cross(u, v)
        normal /= np.linalg.norm(normal)
        to_eye = (eye - middle) / np.linalg.norm(eye - middle)
        mirrored = 2 * (normal @ to_eye) * normal - to_eye
        # Along the plates nothing changes: what counts is how far the ray passes from the lamp in y and z.
        offset = (np.array(largest["centre"]) - middle)[1:]
        ray = mirrored[1:] / np.linalg.norm(mirrored[1:])
        assert abs(offset[0] * ray[1] - offset[1] * ray[0]) < largest["radius"]


def test_the_prism_is_at_minimum_deviation(compiled: Compile) -> None:
    scene = compiled(read("prism"))
    interior = scene.interiors[scene.surfaces[0].interior]
    [n] = spectra.evaluate(scene.spectra[interior.index], np.array([587.5618]))
    slit, screen = scene.surfaces[1].quad, scene.surfaces[2].quad
    # Through the prism the light is level; before, it climbs by half of the deviation, then it falls as much.
    half = np.arcsin(n * np.sin(np.pi / 6)) - np.pi / 6
    for quad, slope in ((slit, half), (screen, np.pi - half)):
        u, v = ([edge.x, edge.y, edge.z] for edge in (quad.edge_u, quad.edge_v))
        normal = np.cross(u, v)
        assert np.arctan2(normal[1], normal[0]) == pytest.approx(slope, abs=1e-3)
    # Four wavelengths travel together until the glass parts them.
    assert scene.tracing.group == 4


def test_the_glossy_spheres_have_a_sky(compiled: Compile, blobs: BlobStore, tmp_path: Path) -> None:
    script = runpy.run_path(str(SCENES / "glossy_spheres" / "make_map.py"))
    script["main"](tmp_path)
    document = read("glossy_spheres")
    document["environment"]["asset"] = f"sha256:{blobs.put((tmp_path / 'sky.exr').read_bytes())}"
    scene = compiled(document)
    assert (scene.environment.map.columns, scene.environment.map.rows) == (512, 256)
    assert not scene.luminaires
