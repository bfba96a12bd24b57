"""Smoke from a file: attenuation along rays through a grid, from OpenVDB to the image."""

import json
import subprocess
from math import exp
from pathlib import Path

import numpy as np
import pytest
from nocturne_client.local.programs import find_program, need_program
from nocturne_scene.validation.documents import measured_scene

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = [
    pytest.mark.system,
    pytest.mark.skipif(find_program("nocturne-grid") is None, reason="nocturne-grid is not built"),
]

_DIMS = (6, 5, 8)
_VOXEL = 0.25


def _smoke(folder: Path) -> np.ndarray:
    """Writes smoke.vdb, with random densities, sparse; returns them, [x, y, z]."""
    values = np.random.default_rng(7).random(_DIMS, dtype=np.float32)
    values[values < 0.3] = 0.0
    (folder / "density.raw").write_bytes(values.astype("<f4").tobytes())
    grids = [{"name": "density", "file": "density.raw"}]
    description = {"dims": _DIMS, "voxel_size": _VOXEL, "origin": [1.0, 2.0, 3.0], "grids": grids}
    (folder / "smoke.json").write_text(json.dumps(description))
    program = need_program("nocturne-grid")
    subprocess.run(
        [program, "create", folder / "smoke.json", "-o", folder / "smoke.vdb"],
        check=True,
        capture_output=True,
    )
    return values


@pytest.mark.parametrize("nearest", [True, False])
def test_attenuation_through_smoke(nearest: bool, tmp_path: Path) -> None:
    """Along a column of voxels the optical depth is the sum of densities times the voxel's size, whether they
    are constant over voxels or linear between their centres. Turned and moved. False alarms: 0.01.
    """
    values = _smoke(tmp_path)
    where: Document = {"rotate": {"axis": [0, 1, 0], "degrees": 90}, "translate": [0, -2, 1]}
    density = {"asset": "smoke.vdb", "grid": "density", "factor": 1.5, "nearest": nearest, **where}
    shape = {"type": "medium_box", "medium": "smoke"}
    columns = ((0, 0), (2, 3), (5, 4))
    for x, y in columns:
        # Before it was turned about y: z becomes x, x becomes -z.
        place = np.array([1.0 + _VOXEL * x, 2.0 + _VOXEL * y - 2.0, 0.0])
        position = [0.0, float(place[1]), float(1.0 - place[0])]
        sensor = {
            "type": "radiance_meter",
            "position": position,
            "look_at": [1.0, position[1], position[2]],
            "diameter": 1e-4,
            "cone_degrees": 0.001,
        }
        document = measured_scene(sensor, [{"shape": shape, "interior": {"media": ["smoke"]}}])
        document |= {
            "media": {"smoke": {"absorption": 2.0, "density": density}},
            "environment": {"radiance": 1.0},
        }
        folder = tmp_path / f"{x}{y}"
        folder.mkdir()
        (folder / "smoke.vdb").write_bytes((tmp_path / "smoke.vdb").read_bytes())
        depth = 2.0 * 1.5 * _VOXEL * float(values[x, y].sum())
        Measurement(document, folder, 8, 8).by_pixels(64).check(exp(-depth), 1e-4, values=len(columns))


@pytest.mark.parametrize(("beside", "depth"), [(0.0, 5.0132565), (0.4, 3.0406938), (0.8, 0.6784705)])
def test_attenuation_through_a_gaussian(beside: float, depth: float, tmp_path: Path) -> None:
    """5 exp(-r^2 / (2 x 0.4^2)) per metre: 5 x 0.4 sqrt(2 pi) exp(-b^2 / 0.32) at a distance b from it.

    Along rays through voxel centres the sum over voxels is the integral to 1e-7. False alarms: 0.01.
    """
    h, half = 0.05, 40
    along = h * np.arange(-half, half + 1)
    x, y, z = np.meshgrid(along, along, along, indexing="ij")
    (tmp_path / "ball.f32").write_bytes(np.exp(-(x * x + y * y + z * z) / 0.32).astype("<f4").tobytes())
    description = {
        "dims": x.shape,
        "voxel_size": h,
        "origin": [-half * h] * 3,
        "grids": [{"name": "density", "file": "ball.f32"}],
    }
    (tmp_path / "ball.json").write_text(json.dumps(description))
    program = need_program("nocturne-grid")
    subprocess.run(
        [program, "create", tmp_path / "ball.json", "-o", tmp_path / "ball.vdb"],
        check=True,
        capture_output=True,
    )
    sensor = {
        "type": "radiance_meter",
        "position": [beside, 0.0, 5.0],
        "look_at": [beside, 0.0, 0.0],
        "diameter": 1e-5,
        "cone_degrees": 1e-4,
    }
    shape = {"type": "medium_box", "medium": "smoke"}
    document = measured_scene(sensor, [{"shape": shape, "interior": {"media": ["smoke"]}}])
    document |= {
        "media": {"smoke": {"absorption": 5.0, "density": {"asset": "ball.vdb", "grid": "density"}}},
        "environment": {"radiance": 1.0},
    }
    Measurement(document, tmp_path, 8, 8).by_pixels(4096).check(exp(-depth), 1e-5, values=3)
