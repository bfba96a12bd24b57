"""Lamps as the rays of a file become rays and a spectrum; those that can't light a meter are refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.photometry import tm25

from .conftest import Compile, expect_problem
from .test_tm25 import lambertian

_LED = np.array([400.0, 550.0, 700.0]), np.array([0.25, 1.0, 0.5])


def _kept(blobs: BlobStore, folder: Path, rays: tm25.RayFile) -> str:
    path = folder / "lamp.tm25ray"
    tm25.write(path, rays)
    return f"sha256:{blobs.put(path.read_bytes())}"


@pytest.fixture
def lit(document: dict[str, Any], blobs: BlobStore, tmp_path: Path) -> dict[str, Any]:
    """A film, and rays alone that light it."""
    del document["surfaces"][1]
    document["sensor"] = {
        "type": "irradiance_meter",
        "position": [0, 0, 1],
        "normal": [0, 0, -1],
        "height": 1,
    }
    document["ray_files"] = [{"asset": _kept(blobs, tmp_path, lambertian(50, spectra=[_LED]))}]
    return document


def _rays(scene: scene_pb2.CompiledScene, blobs: BlobStore) -> np.ndarray:
    found = np.fromfile(blobs.path(scene.ray_sets[0].blob.hex()), dtype="<f4").reshape(-1, 7)
    assert len(found) == scene.ray_sets[0].count
    return found


def test_rays_are_placed_and_have_their_lumens(
    lit: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    lit["ray_files"][0] |= {
        "translate": [1, 2, 3],
        "rotate": {"axis": [1, 0, 0], "degrees": 180},
        "lumens": 500,
        "dimming": 0.5,
    }
    scene = compiled(lit)
    assert scene.format == 9
    assert scene.tracing.direction == scene_pb2.DIRECTION_FORWARD
    found, rays = _rays(scene, blobs), lambertian(50)
    turned = np.array([1, -1, -1])
    np.testing.assert_allclose(found[:, :3], rays.starts * turned + [1, 2, 3], atol=1e-6)
    np.testing.assert_allclose(found[:, 3:6], rays.directions * turned, atol=1e-6)
    assert found[:, 6].sum() == pytest.approx(250.0)
    # W/nm of a lumen.
    of_a_lumen = scene.spectra[scene.ray_sets[0].spectrum]
    assert spectra.luminance(of_a_lumen) == pytest.approx(1.0)
    at = spectra.evaluate(of_a_lumen, np.array([400.0, 550.0, 625.0]))
    np.testing.assert_allclose(at / at[1], [0.25, 1.0, 0.75], rtol=1e-6)


def test_a_spectrum_may_be_given(lit: dict[str, Any], compiled: Compile) -> None:
    lit["ray_files"][0]["radiance"] = {"illuminant": "A"}
    scene = compiled(lit)
    warm = spectra.evaluate(scene.spectra[scene.ray_sets[0].spectrum], np.array([450.0, 650.0]))
    assert warm[1] / warm[0] > 3


def test_rays_are_of_a_light_group(lit: dict[str, Any], compiled: Compile) -> None:
    lit["ray_files"] += [lit["ray_files"][0] | {"light_group": "spot"}]
    scene = compiled(lit)
    assert [each.light_group for each in scene.ray_sets] == [0, 1]
    assert {each.name for each in scene.sensor.further_responses} >= {"spot.Y", "rest.Y"}


def test_only_meters_see_them(lit: dict[str, Any], blobs: BlobStore) -> None:
    camera = {"type": "pinhole", "position": [0, 0, 2], "look_at": [0, 0, 0]}
    lit["sensor"] = camera | {"vertical_field_of_view_degrees": 40}
    expect_problem(lit, blobs, "$.ray_files", "these don't meet a pinhole")


def test_photons_from_the_sensor_are_refused(lit: dict[str, Any], blobs: BlobStore) -> None:
    lit["tracing"] = {"direction": "adjoint"}
    expect_problem(lit, blobs, "$.tracing.direction", "don't find the rays of files")


def test_lights_that_photons_cant_start_from_are_refused(lit: dict[str, Any], blobs: BlobStore) -> None:
    """Photons of a sky don't know the media that fill all of space."""
    lit |= {"media": {"fog": {"scattering": 1}}, "unbounded_media": ["fog"], "environment": {"radiance": 1}}
    expect_problem(lit, blobs, "$.ray_files", "not all light of this scene can start so")


def test_a_file_without_a_spectrum_needs_one(
    lit: dict[str, Any], compiled: Compile, blobs: BlobStore, tmp_path: Path
) -> None:
    lit["ray_files"][0]["asset"] = _kept(blobs, tmp_path, lambertian(50))
    expect_problem(lit, blobs, "$.ray_files[0].asset", "no spectrum; expected a radiance")
    lit["ray_files"][0]["radiance"] = {"blackbody": 4000}
    assert _rays(compiled(lit), blobs)[:, 6].sum() == pytest.approx(1000.0)


def test_another_file_is_refused_by_its_byte(lit: dict[str, Any], blobs: BlobStore) -> None:
    lit["ray_files"][0]["asset"] = f"sha256:{blobs.put(b'IESNA:LM-63-2002')}"
    expect_problem(lit, blobs, "$.ray_files[0].asset", "byte 16: the file ends")
