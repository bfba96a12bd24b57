"""White furnaces: a medium that absorbs nothing is invisible in even light, whatever it is.

Each group of photons brings back 1, so every pixel is 1 to rounding: no statistics.
"""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from nocturne_client.local.programs import find_program, need_program
from nocturne_scene.validation.documents import measured_scene, sphere

from tests.accuracy.agreement import ROUNDING
from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_CAMERA: Document = {
    "type": "pinhole",
    "position": [0, 0.5, 4],
    "look_at": [0, 0, 0],
    "vertical_field_of_view_degrees": 30,
}


def _check(
    bodies: list[Document],
    media: Document,
    folder: Path,
    rounding: float = ROUNDING,
    camera: Document = _CAMERA,
    **more: Any,
) -> Measurement:
    """No photon is aimed or dies."""
    tracing = {"estimator": "mixture", "mixture": {"kernel": 1.0, "environment": 0.0}, "h": 1e6}
    document = measured_scene(camera, bodies, **tracing)
    document |= {"media": media, "environment": {"radiance": 1.0}, **more}
    measurement = Measurement(document, folder, 16, 16)
    grey = measurement.image(16).further["grey"].astype(np.float64) / (830.0 - 360.0)
    # Paths that the tracer's own limit ended are missing, and counted: few of thousands in thick white media.
    photons = measurement.statistics["photons"] / grey.size
    lost = np.round((1.0 - grey) * photons)
    assert lost.sum() == measurement.statistics["truncated_paths"]
    assert grey + lost / photons == pytest.approx(np.ones((16, 16)), rel=rounding)
    # Boundaries are two rays; the rest are collisions, so that the medium was there.
    assert measurement.statistics["rays"] > 1.5 * 16 * 16 * 16
    return measurement


def _filled(shape: Document, *media: str) -> Document:
    return {"shape": shape, "interior": {"media": list(media)}}


def _mesh(mesh: trimesh.Trimesh) -> Document:
    return {"type": "mesh", "vertices": mesh.vertices.tolist(), "triangles": mesh.faces.tolist()}


def _lump() -> trimesh.Trimesh:
    """A closed surface with hollows and overhangs."""
    mesh = trimesh.creation.icosphere(subdivisions=4)
    x, y, z = mesh.vertices.T
    radius = 0.6 + 0.3 * np.sin(5.0 * x + 1.0) * np.sin(4.0 * y) + 0.2 * np.sin(7.0 * z + 2.0 * x)
    return trimesh.Trimesh(mesh.vertices * radius[:, None], mesh.faces)


_TORUS = trimesh.creation.torus(major_radius=0.7, minor_radius=0.3)


@pytest.mark.parametrize("mesh", [_TORUS, _lump()], ids=["torus", "lump"])
@pytest.mark.parametrize(("extinction", "g"), [(1.0, 0.0), (30.0, 0.85)])
def test_meshes(mesh: trimesh.Trimesh, extinction: float, g: float, tmp_path: Path) -> None:
    phase = {"type": "henyey_greenstein", "g": g}
    _check([_filled(_mesh(mesh), "fog")], {"fog": {"scattering": extinction, "phase": phase}}, tmp_path)


def test_into_an_edge(tmp_path: Path) -> None:
    """Where two faces meet, rounding makes photons cross both; none of them may stay in the body without end.

    In a white fog without an end they are lost after a million collisions each: of engine 20, one of sixteen.
    """
    box = trimesh.creation.box((20.0, 1.0, 20.0))
    camera = _CAMERA | {
        "position": [0, 1.5, 15],
        "look_at": [0, 0.5, 10],
        "vertical_field_of_view_degrees": 1e-4,
    }
    white = {"fog": {"scattering": 1.0}}
    measurement = _check([_filled(_mesh(box), "fog")], white, tmp_path, camera=camera)
    assert measurement.statistics["truncated_paths"] == 0


def test_instances_of_instances(tmp_path: Path) -> None:
    """A body of a medium, four of which are a group, which stands there twice, turned and scaled."""
    ball = {"shape": sphere([0, 0, 0], 0.25), "interior": {"media": ["fog"]}}
    four = [
        {"group": "balls", "translate": [0.5 * x, 0.5 * y, 0.1 * x]} for x in (-1.0, 1.0) for y in (-1.0, 1.0)
    ]
    placed = [
        {"group": "four", "rotate": {"axis": [1, 2, 3], "degrees": 40}, "scale": 0.9},
        {"group": "four", "rotate": {"axis": [0, 1, 0], "degrees": 70}, "translate": [0.1, 0.2, 0.3]},
    ]
    groups = {"balls": [ball], "four": four}
    _check([], {"fog": {"scattering": 8.0}}, tmp_path, groups=groups, instances=placed)


_COSINES = np.linspace(-1.0, 1.0, 9).tolist()
_PHASES: dict[str, Document] = {
    "isotropic": {"scattering": 3.0},
    "forward": {"scattering": 30.0, "phase": {"type": "henyey_greenstein", "g": 0.99}},
    "backward": {"scattering": 3.0, "phase": {"type": "henyey_greenstein", "g": -0.9}},
    "double": {
        "scattering": 3.0,
        "phase": {"type": "double_henyey_greenstein", "first": 0.8, "second": -0.4, "weight": 0.7},
    },
    "rayleigh": {
        "scattering": {"table": [[400, 9.0], [700, 1.0]]},
        "phase": {"type": "rayleigh", "depolarisation": {"table": [[400, 0.3], [700, 0.0]]}},
    },
    "table": {
        "scattering": 3.0,
        "phase": {
            "type": "tabulated",
            "cosines": _COSINES,
            "wavelengths": [400, 700],
            "values": [[1.0 + each**2 for each in _COSINES], [2.0 + 1.9 * each for each in _COSINES]],
        },
    },
    "droplets": {"preset": "continental haze", "density": 1e5},
}


@pytest.mark.parametrize("phase", _PHASES)
@pytest.mark.parametrize("density", ["constant", "exponential"])
def test_phase_functions(phase: str, density: str, tmp_path: Path) -> None:
    fog = dict(_PHASES[phase])
    if density == "exponential":
        at_ground = 2.0 * fog.get("density", 1.0)
        fog["density"] = {"scale_height": 0.5, "at_ground": at_ground, "above": {"up": [0.3, 1, 0]}}
    _check([_filled(sphere([0, 0, 0], 1.0), "fog")], {"fog": fog}, tmp_path)


@pytest.mark.skipif(find_program("nocturne-grid") is None, reason="nocturne-grid is not built")
@pytest.mark.parametrize("nearest", [True, False])
@pytest.mark.parametrize("factor", [5.0, 500.0])
def test_a_cloud(nearest: bool, factor: float, tmp_path: Path) -> None:
    """A sparse grid of random values, in its box, in a ball that cuts it, and around air."""
    cells = 20
    values = np.random.default_rng(3).random((cells, cells, cells), dtype=np.float32) ** 3
    values[values < 0.2] = 0.0
    (tmp_path / "cloud.f32").write_bytes(values.astype("<f4").tobytes())
    description = {
        "dims": [cells] * 3,
        "voxel_size": 0.1,
        "origin": [-0.95] * 3,
        "grids": [{"name": "density", "file": "cloud.f32"}],
    }
    (tmp_path / "cloud.json").write_text(json.dumps(description))
    program = need_program("nocturne-grid")
    subprocess.run(
        [program, "create", tmp_path / "cloud.json", "-o", tmp_path / "cloud.vdb"],
        check=True,
        capture_output=True,
    )
    density = {"asset": "cloud.vdb", "grid": "density", "factor": factor, "nearest": nearest}
    cloud = {"scattering": 1.0, "density": density, "phase": {"type": "henyey_greenstein", "g": 0.6}}
    bodies = [
        _filled({"type": "medium_box", "medium": "cloud"}, "cloud", "air"),
        _filled(sphere([0.8, 0, 0], 0.9), "cloud"),
    ]
    air = {"scattering": {"table": [[400, 0.5], [700, 0.1]]}, "phase": {"type": "rayleigh"}}
    # After a thousand collisions among two media a weight is rounded a thousand times.
    _check(bodies, {"cloud": cloud, "air": air}, tmp_path, 1e-4)


@pytest.mark.parametrize("g", [0.0, 0.9])
def test_optical_thickness_10000_in_a_box(g: float, tmp_path: Path) -> None:
    """Dense only at the bottom; a photon that comes in far down has some 1e4 collisions."""
    density = {"scale_height": 0.2, "at_ground": 2e4, "above": {"point": [0, -0.5, 0]}}
    fog = {"scattering": 1.0, "density": density, "phase": {"type": "henyey_greenstein", "g": g}}
    box = {"type": "box", "minimum": [-0.5, -0.5, -0.5], "maximum": [0.5, 0.5, 0.5]}
    _check([_filled(box, "fog")], {"fog": fog}, tmp_path)
