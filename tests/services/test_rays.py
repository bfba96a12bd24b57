"""`nocturne rays`: what leaves a lamp as a ray file has its flux, its far field and its near field."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.rays import Asked, write_rays
from nocturne_scene.photometry import far_field, tm25
from nocturne_scene.photometry.meter_images import flux_of

from tests.accuracy.tracing import Document, trace

_METER = {"type": "intensity_meter", "position": [1, 2, 3], "lamp_radius": 0.14}
_BLACK = {"type": "lambertian", "reflectance": 0}


def _lamp() -> list[Document]:
    """A small square that emits 1000 lm, half of it behind a white flag: nothing about it is symmetric."""
    quad = {"type": "quad", "corner": [0.98, 2, 2.97], "edge_u": [0.05, 0.02, 0], "edge_v": [0, 0, 0.05]}
    flag = {"type": "quad", "corner": [0.95, 1.93, 2.9], "edge_u": [0, 0, 0.2], "edge_v": [0.03, 0.05, 0]}
    return [
        {
            "shape": quad,
            "kernel": _BLACK,
            "luminaire": {"radiance": {"illuminant": "LED-B3"}, "lumens": 1000},
        },
        {"shape": flag, "kernel": {"type": "lambertian", "reflectance": 0.8}},
    ]


def _scene(folder: Path, sensor: Document = _METER, **more: Any) -> Path:
    path = folder / "lamp.json"
    path.write_text(json.dumps({"nocturne": 1, "sensor": sensor, "surfaces": _lamp(), **more}))
    return path


def _rays(folder: Path, photons: int, threads: int = 2, **changes: Any) -> tm25.RayFile:
    output = folder / "lamp.tm25ray"
    write_rays(Asked(_scene(folder), output, photons, threads, None, changes))
    return tm25.read(output)


def test_rays_have_the_flux_and_the_far_field_of_the_lamp(tmp_path: Path) -> None:
    """As the intensity meter finds them by adjoint photons, in each of 6 x 6 angles and in sum."""
    rays = _rays(tmp_path, 200_000)
    candela, error = far_field.candela_of(rays, 6, 6)
    (tmp_path / "meter").mkdir()
    document = json.loads(_scene(tmp_path).read_text()) | {"tracing": {"direction": "adjoint", "sharing": 1}}
    image = trace(document, tmp_path / "meter", 6, 16384)
    z = (candela - image.y) / np.hypot(error, image.y_stderr)
    lit = image.y > 0
    assert lit.sum() > 20
    assert np.all(candela[~lit] < 0.01)
    assert np.abs(z[lit]).max() < 4.0
    lumens, its_error = flux_of(candela, error)
    truth, other_error = flux_of(image.y, image.y_stderr.astype(np.float64))
    assert lumens == pytest.approx(truth, abs=4 * float(np.hypot(its_error, other_error)))
    # Lumens are watts by their wavelengths.
    assert rays.lumens is not None
    assert rays.watts is not None
    assert lumens == pytest.approx(float(rays.lumens.sum(dtype=np.float64)), rel=1e-6)
    assert 200 < rays.lumens.sum() / rays.watts.sum() < 400


def test_rays_leave_the_sphere(tmp_path: Path) -> None:
    rays = _rays(tmp_path, 5000)
    starts, directions = rays.starts.astype(np.float64), rays.directions.astype(np.float64)
    assert np.linalg.norm(starts, axis=1) == pytest.approx(np.full(len(starts), 0.14), rel=1e-5)
    assert np.all(np.sum(starts * directions, axis=1) > 0)


def test_any_number_of_threads_writes_the_same_bytes(tmp_path: Path) -> None:
    written = []
    for threads in (1, 3):
        _rays(tmp_path, 100_000, threads)
        written.append((tmp_path / "lamp.tm25ray").read_bytes())
    assert written[0] == written[1]
    _rays(tmp_path, 100_000, 1, **{"tracing.seed": 5})
    assert (tmp_path / "lamp.tm25ray").read_bytes() != written[0]


def test_a_lamp_as_rays_lights_a_near_film_as_it_does_itself(tmp_path: Path) -> None:
    """Out and in again: 0.25 m below the lamp, which is outside of the sphere. The rays are a draw of their
    own, which adds the error of those that meet the film."""
    _rays(tmp_path, 400_000)
    sensor = {
        "type": "irradiance_meter",
        "position": [1, 1.75, 3],
        "normal": [0, 1, 0],
        "up": [0, 0, 1],
        "height": 0.6,
    }
    (tmp_path / "itself").mkdir()
    itself = json.loads(_scene(tmp_path, sensor, tracing={"direction": "adjoint", "sharing": 1}).read_text())
    truth = trace(itself, tmp_path / "itself", 4, 8192)
    # The file's z is down, its x the scene's: z to -y.
    stands = {"rotate": {"axis": [1, 0, 0], "degrees": 90}, "translate": [1, 2, 3]}
    again = {
        "nocturne": 1,
        "sensor": sensor,
        "surfaces": [{"shape": {"type": "sphere", "centre": [1, 9, 3], "radius": 0.1}, "kernel": _BLACK}],
        "ray_files": [{"asset": "lamp.tm25ray", **stands}],
        "tracing": {"sequence": "independent"},
    }
    image = trace(again, tmp_path, 4, 1 << 16)
    rays = tm25.read(tmp_path / "lamp.tm25ray")
    assert rays.lumens is not None
    lumens = rays.lumens.astype(np.float64)
    of_pixel = image.y * (0.6 / 4) ** 2
    # Of a sum of some of n draws, of which each has this mean square.
    from_file = np.sqrt(of_pixel * np.square(lumens).sum() / lumens.sum()) / (0.6 / 4) ** 2
    z = (image.y - truth.y) / np.sqrt(image.y_error**2 + truth.y_error**2 + from_file**2)
    assert truth.y.max() > 3 * truth.y.min()
    assert np.abs(z).max() < 4.5
    assert abs(z.mean()) < 4 / np.sqrt(z.size)


def test_another_sensor_or_ending_is_refused(tmp_path: Path) -> None:
    scene = _scene(tmp_path, {"type": "radiance_meter"})
    with pytest.raises(
        NocturneClientError, match="the sensor is radiance_meter; expected an intensity_meter"
    ):
        write_rays(Asked(scene, tmp_path / "lamp.tm25ray", 10, 1, None, {}))
    with pytest.raises(NocturneClientError, match=r"expected a name that ends in \.tm25ray"):
        write_rays(Asked(_scene(tmp_path), tmp_path / "lamp.ray", 10, 1, None, {}))
