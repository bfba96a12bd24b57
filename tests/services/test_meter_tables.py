"""`nocturne measure --meters`: a line for each meter of an image, among them those on faces."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.measuring import measure_file
from typer.testing import CliRunner

pytestmark = pytest.mark.system


def _run(*words: str | Path) -> str:
    result = CliRunner().invoke(app, [*map(str, words)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def _image(folder: Path, sensor: dict[str, Any]) -> Path:
    """A grey box under a lamp."""
    box = {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 1, 1]}
    lamp = {"type": "sphere", "centre": [0.5, 3, 0.5], "radius": 0.1}
    document = {
        "nocturne": 1,
        "sensor": sensor,
        "surfaces": [
            {"name": "box", "shape": box, "kernel": {"type": "lambertian", "reflectance": 0.5}},
            {
                "shape": lamp,
                "kernel": {"type": "lambertian", "reflectance": 0},
                "luminaire": {"radiance": {"illuminant": "D65"}, "lumens": 1000},
            },
        ],
    }
    (folder / "scene.json").write_text(json.dumps(document))
    image = folder / "image.exr"
    _run("render", folder / "scene.json", "-o", image, "--samples", "16", "--width", "4", "--height", "4")
    return image


def test_a_line_for_each_meter(tmp_path: Path) -> None:
    image = _image(
        tmp_path,
        {
            "type": "meters",
            "instruments": [
                {"name": "sides", "faces": {"surface": "box", "count": 6, "distance": 0.25}},
                {"name": "air", "points": [[2, 0, 0], [0, 2, 0]], "normals": [[-1, 1, 0], [0, 1, 0]]},
            ],
        },
    )
    lines = [*csv.DictReader(_run("measure", image, "--meters").splitlines())]
    assert [each["instrument"] for each in lines] == ["sides"] * 6 + ["air"] * 2
    assert [each["meter"] for each in lines] == ["0", "1", "2", "3", "4", "5", "0", "1"]
    places = [tuple(float(each[axis]) for axis in "xyz") for each in lines]
    assert places[3] == pytest.approx((0.5, 1.25, 0.5))
    assert places[2] == pytest.approx((0.5, -0.25, 0.5))
    values = [float(each["value lx"]) for each in lines]
    # The top alone is lit.
    assert [value > 0 for value in values[:6]] == [False, False, False, True, False, False]
    assert values[3] == pytest.approx(1000 / (4 * 3.14159265) / 1.75**2, rel=0.05)
    assert all(float(each["standard_error"]) >= 0 for each in lines)
    sides, air = measure_file(image, [], "Y", 0).measurements
    assert sides.mean == pytest.approx(sum(values[:6]) / 6, rel=1e-6)
    assert air.mean == pytest.approx(sum(values[6:]) / 2, rel=1e-6)


def test_other_images_have_none(tmp_path: Path) -> None:
    film = {"type": "irradiance_meter", "position": [0, 2, 0], "normal": [0, 1, 0], "height": 0.1}
    image = _image(tmp_path, film)
    with pytest.raises(NocturneClientError, match="no meters"):
        _run("measure", image, "--meters")
    with pytest.raises(NocturneClientError, match="of a file"):
        _run("measure", "abcdef", "--meters")
