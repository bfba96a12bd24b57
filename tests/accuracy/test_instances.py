"""Instances whose matrices stretch and mirror. A document's placements can't, a compiled scene's can."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to

from tests.accuracy.agreement import ROUNDING, sidak_bound
from tests.accuracy.scenes import BLACK, furnace, sphere, surface
from tests.accuracy.spectral_meters import Y_PER_RADIANCE, Estimate, flat
from tests.accuracy.tracing import Document, run, write
from tests.system.images import Image

pytestmark = pytest.mark.system

Matrix = npt.NDArray[np.float64]

_TURN = np.array([[0.6, -0.8, 0.0], [0.48, 0.36, -0.8], [0.64, 0.48, 0.6]])
_SHEAR = np.array([[1.0, 0.5, 0.0], [0.0, 1.0, -2.0], [0.0, 0.0, 1.0]])

MATRICES = {
    "stretched": np.diag([1.0, 1.0, 1e4]),
    "mirrored": np.diag([-1.0, 1.0, 1.0]),
    "sheared": _TURN @ np.diag([1e-2, 1.0, 30.0]) @ _SHEAR,
}


@pytest.mark.parametrize("name", MATRICES)
def test_furnace(name: str, tmp_path: Path) -> None:
    """A box that its matrix makes the unit furnace, so radiance is L / (1 - albedo) everywhere.

    A normal that is not by the inverse transpose would send light out of the box, or see no lamp. z within
    the Sidak bound of three; false alarms: 0.01.
    """
    matrix = MATRICES[name]
    document = furnace(0.5, 1.0)
    for wall in document["surfaces"]:
        shape = wall["shape"]
        for key in ("corner", "edge_u", "edge_v"):
            shape[key] = np.linalg.solve(matrix, shape[key]).tolist()
        if np.linalg.det(matrix) < 0:
            shape["edge_u"], shape["edge_v"] = shape["edge_v"], shape["edge_u"]
    image = _instanced(document, matrix, tmp_path, (16, 16), 256)
    Estimate.of(flat(image)).check(2.0, sidak_bound(3), name)


def test_an_ellipsoid_has_the_power_of_its_shadow(tmp_path: Path) -> None:
    """A sphere as an ellipsoid of half axes 0.5, 0.05, 1: towards d the intensity is the radiance times the
    shadow's area, pi a b c |A^-1 d|.

    z within the Sidak bound of all pixels, standard errors as of independent points; false alarms: 0.01.
    """
    axes = np.array([0.5, 0.05, 1.0])
    sensor = {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": 1.01, "axis": [0, 0, 1]}
    document: Document = {
        "nocturne": 1,
        "sensor": sensor,
        "surfaces": [surface(sphere([0, 0, 0], 1.0), BLACK, 1.0)],
    }
    rows, columns = 6, 8
    image = _instanced(document, np.diag(axes), tmp_path, (columns, rows), 16384)
    truth = _shadows(axes, rows, columns)
    error = image.y_error / Y_PER_RADIANCE
    assert (error < 0.05 * truth).all()
    assert (np.abs(flat(image) - truth) < sidak_bound(truth.size) * error + ROUNDING * truth).all()


def _shadows(axes: Matrix, rows: int, columns: int, fine: int = 64) -> Matrix:
    """Means over the pixels' solid angles, by the midpoint rule."""
    v = (np.arange(rows * fine) + 0.5) * pi / (rows * fine)
    h = (np.arange(columns * fine) + 0.5) * 2 * pi / (columns * fine)
    sines = np.sin(v)[:, None]
    towards = np.stack([sines * np.cos(h), sines * np.sin(h), np.cos(v)[:, None] + 0 * h])
    areas = pi * axes.prod() * np.linalg.norm(towards / axes[:, None, None], axis=0)
    blocks = (rows, fine, columns, fine)
    weights = sines + 0 * h
    return np.asarray(
        (areas * weights).reshape(blocks).sum(axis=(1, 3)) / weights.reshape(blocks).sum(axis=(1, 3))
    )


def _instanced(
    document: Document, matrix: Matrix, folder: Path, film: tuple[int, int], samples: int
) -> Image:
    """All surfaces of a document as a group, once, by a matrix."""
    changed: dict[str, Any] = {**document, "groups": {"all": document["surfaces"]}, "surfaces": []}
    changed["instances"] = [{"group": "all"}]
    compiled = compile_to(write(changed, folder), folder, *film, samples)
    scene = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())
    [instance] = scene.instances
    instance.transforms[:] = np.column_stack([matrix, np.zeros(3)]).ravel().tolist()
    stretched = replace(compiled, scene=folder / "stretched.pb")
    stretched.scene.write_bytes(scene.SerializeToString(deterministic=True))
    return run(stretched, folder)[0]
