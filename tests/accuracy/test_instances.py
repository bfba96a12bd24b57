"""Instances: of media, and whose matrices stretch and mirror (a document's can't, a compiled scene's can)."""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to
from nocturne_scene.validation.documents import BLACK, box, furnace, quad, sphere, surface

from tests.accuracy.agreement import ROUNDING, compare, sidak_bound
from tests.accuracy.spectral_meters import Y_PER_RADIANCE, Estimate, flat
from tests.accuracy.tracing import IN_FULL, Document, run, trace, write
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


@pytest.mark.parametrize("direction", ["adjoint", "forward"])
def test_an_ellipsoid_has_the_power_of_its_shadow(direction: str, tmp_path: Path) -> None:
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
        "tracing": {"direction": direction},
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


_PLACES: list[Document] = [
    {"scale": 0.7, "rotate": {"axis": [1, 2, 3], "degrees": 50}, "translate": [-0.7, 0.1, 0.0]},
    {"scale": 1.2, "rotate": {"axis": [0, 1, 0], "degrees": -70}, "translate": [0.7, -0.1, 0.3]},
]


def _bodies_of_media() -> list[Document]:
    """Smoke that fog overlaps, and a block of murky glass that stands in it and keeps it out."""
    ball = {"shape": sphere([0, 0, 0], 0.5), "interior": {"media": ["smoke"]}}
    bank = {"shape": box([-0.6, -0.2, -0.6], [0.6, 0.3, 0.6]), "interior": {"media": ["fog"]}}
    glass = {"type": "dielectric", "index": 1.5, "roughness": 0.2}
    block = {"shape": box([0.1, -0.3, -0.2], [0.4, 0.1, 0.2]), "kernel": glass}
    return [ball, bank, block | {"interior": {"media": ["murk"]}}]


def test_media_in_instances_are_those_of_bodies_placed_directly(tmp_path: Path) -> None:
    """Coefficients are per metre of the scene, whatever an instance's scale. False alarms: 0.023.

    A tenth more absorption in the smoke moves the mean by ten standard errors.
    """
    phase = {"type": "henyey_greenstein", "g": 0.6}
    lamp = surface(quad([-1, 2, -1], [2, 0, 0], [0, 0, 2]), BLACK, 3.0, two_sided=True)
    sensor: Document = {"type": "pinhole", "position": [0, 0.4, 4], "look_at": [0, 0, 0]}
    scene: Document = {
        "nocturne": 1,
        "sensor": sensor | {"vertical_field_of_view_degrees": 36},
        "media": {
            "smoke": {"scattering": {"table": [[400, 6], [700, 2]]}, "absorption": 1.5, "phase": phase},
            "fog": {"scattering": 1.0, "absorption": {"table": [[400, 0.1], [700, 1.0]]}},
            "murk": {"scattering": 10.0, "absorption": 1.0},
        },
        "environment": {"radiance": 0.3},
    }
    bodies = [body | place for place in _PLACES for body in _bodies_of_media()]
    instances = [{"group": "bodies", **place} for place in _PLACES]
    direct: Document = {"surfaces": [lamp, *bodies]}
    grouped: Document = {"surfaces": [lamp], "groups": {"bodies": _bodies_of_media()}, "instances": instances}
    images = []
    for seed, part in enumerate((direct, grouped)):
        folder = tmp_path / str(seed)
        folder.mkdir()
        tracing = {"seed": seed, "sequence": "independent"}
        images.append(trace(scene | part | {"tracing": tracing}, folder, 32 if IN_FULL else 16, 256))
    compare(*images).check()
    assert (images[0].y_error < 0.2 * images[0].y).all()


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
