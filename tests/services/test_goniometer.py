"""`nocturne goniometer`: a lamp's intensities as photometric files, and the standard error of every angle."""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.goniometer import Goniometer, measure_lamp
from nocturne_client.local.local_stop import largest_error
from nocturne_scene.photometry import files, tm25
from nocturne_scene.photometry.intensities import flux
from nocturne_scene.photometry.meter_images import errors_of, flux_of, photometry_of

from tests.scene.test_tm25 import lambertian

_METER = {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": 1}


def _scene(folder: Path, sensor: dict[str, Any] = _METER) -> Path:
    """A square of 1 m2 that emits 1000 lm to one side: 1000 / pi cd straight down."""
    quad = {"type": "quad", "corner": [-0.5, 0, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}
    lamp = {
        "shape": quad,
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": {"illuminant": "D65", "luminance": 1}, "lumens": 1000},
    }
    path = folder / "lamp.json"
    path.write_text(json.dumps({"nocturne": 1, "sensor": sensor, "surfaces": [lamp]}))
    return path


def _measure(folder: Path, scene: Path, error: float, rows: int = 6, **changes: Any) -> list[Path]:
    outputs = [folder / f"lamp{ending}" for ending in (".ies", ".ldt", ".xml")]
    stop = {"angle_error": error}
    measure_lamp(Goniometer(scene, outputs, folder / "lamp.csv", 12, rows, 4096, 2, 1, stop, changes))
    return outputs


@pytest.mark.system
def test_a_lambertian_of_1000_lm(tmp_path: Path) -> None:
    bands = {"sensor.bands": {"first": 400, "last": 700, "width": 100}}
    outputs = _measure(tmp_path, _scene(tmp_path), 0.04, 18, **bands)
    rows = list(csv.DictReader((tmp_path / "lamp.csv").read_text().splitlines()))
    assert len(rows) == 14 * 20  # with both poles, and with 0 and 360 degrees
    read = [files.read(path.read_bytes()) for path in outputs]
    for lamp in read:
        # Means over cells of 10 degrees, linear in between, also over the edge at 90 degrees.
        assert flux(lamp) == pytest.approx(1000, rel=0.01)
        assert lamp.candela == pytest.approx(read[0].candela, rel=1e-9)
    assert read[2].spectrum is not None
    assert read[2].spectrum[0].tolist() == [450, 550, 650]
    for row in rows:
        value, error = float(row["candela"]), float(row["standard_error"])
        angle = np.deg2rad(float(row["vertical_degrees"]))
        if 0 < angle < 1.5:
            assert error <= 0.04 * 1000 / np.pi * 1.05
        # The mean of a cosine over a cell is that at the mean angle within a thousandth of it ahead.
        if 0 < angle < np.pi / 2:
            assert abs(value - 1000 / np.pi * np.cos(angle)) < 5 * error + 0.002 * 1000 / np.pi


@pytest.mark.system
def test_it_stops_by_the_largest_error_of_an_angle(tmp_path: Path) -> None:
    found = {}
    for error in (0.2, 0.02):
        _measure(tmp_path, _scene(tmp_path), error)
        rows = list(csv.DictReader((tmp_path / "lamp.csv").read_text().splitlines()))
        found[error] = max(float(row["standard_error"]) for row in rows) / max(
            float(row["candela"]) for row in rows
        )
        assert found[error] <= error
    assert found[0.02] < found[0.2]


@pytest.mark.parametrize("kind", ["pinhole", "irradiance_meter"])
def test_another_sensor_is_refused(tmp_path: Path, kind: str) -> None:
    with pytest.raises(
        NocturneClientError, match=f"the sensor is {kind}; expected an intensity_meter, or --centre"
    ):
        _measure(tmp_path, _scene(tmp_path, {"type": kind}), 0.1)


def test_another_ending_is_refused(tmp_path: Path) -> None:
    asked = Goniometer(
        _scene(tmp_path), [tmp_path / "lamp.txt"], tmp_path / "lamp.csv", 4, 4, 4, 1, 1, {}, {}
    )
    with pytest.raises(NocturneClientError, match=r"expected a name that ends in \.ies, \.ldt, \.xml"):
        measure_lamp(asked)


def test_flux_and_errors_of_a_meter_on_paper() -> None:
    """Intensities of 1 cd with errors of 0.1: 4 pi lm; poles are means of 8 pixels, seams of 2."""
    candela, error = np.ones((4, 8)), np.full((4, 8), 0.1)
    lumens, its_error = flux_of(candela, error)
    assert lumens == pytest.approx(4 * np.pi)
    rows = 2 * np.pi / 8 * -np.diff(np.cos(np.linspace(0, np.pi, 5)))
    assert its_error == pytest.approx(0.1 * np.sqrt(8 * np.square(rows).sum()))
    found = errors_of(error)
    assert found.shape == photometry_of(candela, {}).candela.shape == (10, 6)
    assert found[:, 0] == pytest.approx(np.full(10, 0.1 / np.sqrt(8)))
    assert found[0, 1:-1] == pytest.approx(np.full(4, 0.1 / np.sqrt(2)))
    assert found[1, 1:-1] == pytest.approx(np.full(4, 0.1))


def test_the_largest_error_is_a_part_of_the_largest_pixel() -> None:
    sums = np.zeros((1, 4, 9))
    # Of 100 samples: means 2 and 1, variances of samples 4 and 0 (and of pixels without light 0).
    sums[0, 0, 1], sums[0, 0, 3] = 200.0, 100 * 4 + 99 * 4
    sums[0, 1, 1], sums[0, 1, 3] = 100.0, 100.0
    found = largest_error(sums, np.full((1, 4), 100, dtype=np.uint32))
    assert found == pytest.approx(0.2 / 2.0, rel=0.05)  # one more find adds a little
    assert largest_error(np.zeros((1, 4, 9)), np.full((1, 4), 100, dtype=np.uint32)) == np.inf


def test_the_far_field_of_a_ray_file(tmp_path: Path) -> None:
    rays, light = lambertian(50_000, texts=["Lamp"]), (np.array([450.0, 550.0]), np.array([0.5, 1.0]))
    tm25.write(tmp_path / "lamp.TM25RAY", replace(rays, spectra=[light]))
    outputs = _measure(tmp_path, tmp_path / "lamp.TM25RAY", 0.01, 36)
    ies, xml = (files.read(outputs[index].read_bytes()) for index in (0, 2))
    assert ies.keywords["LUMINAIRE"] == "Lamp"
    assert ies.candela[:, 0] == pytest.approx(np.full(14, 1000 / np.pi), rel=0.2)
    assert flux(ies) == pytest.approx(1000, rel=0.01)
    assert xml.spectrum is not None
    assert xml.spectrum[1].tolist() == [0.5, 1.0]


def test_a_ray_file_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "lamp.tm25ray").write_bytes(b"TM25")
    with pytest.raises(NocturneClientError, match="byte 4: the file ends; expected a head of 36288 bytes"):
        _measure(tmp_path, tmp_path / "lamp.tm25ray", 0.01)
