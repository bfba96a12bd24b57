"""`nocturne preflight` from end to end: parts that matter by a known factor are kept, others are left out."""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from nocturne_client.cli.preflight_command import preflight
from nocturne_client.local.render import LocalRender, render_scene

from tests.system.images import Image

pytestmark = pytest.mark.system

# Optical thicknesses of two slabs between an orthographic camera and a lamp that fills its view: by Beer's
# law leaving one out makes the image brighter by exp(thickness).
THICK, THIN = 0.5, 0.0002

_ROUNDING = 1e-6


def _slab(name: str, z: float) -> dict[str, Any]:
    return {
        "name": name,
        "shape": {"type": "box", "minimum": [-4, -4, z], "maximum": [4, 4, z + 1]},
        "interior": {"media": [name]},
    }


def _scene(folder: Path) -> Path:
    document = {
        "nocturne": 1,
        "media": {"smoke": {"absorption": THICK}, "haze": {"absorption": THIN}},
        "sensor": {"type": "orthographic", "position": [0, 0, 0], "look_at": [0, 0, 1], "height": 2},
        "surfaces": [
            _slab("smoke", 1),
            _slab("haze", 3),
            {
                # Its normal looks at the camera.
                "shape": {"type": "quad", "corner": [-4, -4, 5], "edge_u": [0, 8, 0], "edge_v": [8, 0, 0]},
                "kernel": {"type": "lambertian", "reflectance": 0},
                "luminaire": {"radiance": {"blackbody": 3000, "luminance": 100}},
            },
        ],
    }
    file = folder / "scene.json"
    file.write_text(json.dumps(document))
    return file


@pytest.fixture(scope="module")
def preflight_found(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    """What the command prints, and the folder with scene.json, taken.json and chart.svg."""
    folder = tmp_path_factory.mktemp("preflight")
    files = ["--take", str(folder / "taken.json"), "--chart", str(folder / "chart.svg")]
    command = [
        sys.executable,
        "-m",
        "nocturne_client",
        "preflight",
        str(_scene(folder)),
        "--error",
        "3%",
        *files,
    ]
    command += ["--width", "32", "--height", "32", "--pilot", "32", "--budget", "6", "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=300)
    found: dict[str, Any] = json.loads(done.stdout)
    return found, folder


def _without(found: dict[str, Any], name: str) -> dict[str, Any]:
    models: list[dict[str, Any]] = found["models"]
    (model,) = (each for each in models if each["without"] == [f'without medium "{name}"'])
    return model


def _holds(interval: dict[str, float], truth: float) -> bool:
    """Absorption has no chance in it, and common seeds take away what wavelengths have: intervals are so
    short that the rounding of the image's 32-bit numbers counts."""
    return interval["low"] - _ROUNDING <= truth <= interval["high"] + _ROUNDING


def test_what_matters_is_needed_by_as_much_as_it_absorbs(
    preflight_found: tuple[dict[str, Any], Path],
) -> None:
    smoke = _without(preflight_found[0], "smoke")
    assert smoke["verdict"] == "needed"
    assert smoke["cpu_seconds"] is None
    assert _holds(smoke["mean_bias"], math.exp(THICK) - 1)
    assert smoke["mean_bias"]["high"] - smoke["mean_bias"]["low"] < 0.01
    # The pixels' scale is that of an even image, 1.01 Y^2, but for the noise of the pilot.
    assert smoke["local_bias"]["value"] == pytest.approx((math.exp(THICK) - 1) / 1.01**0.5, rel=0.02)


def test_what_does_not_matter_is_not_needed(preflight_found: tuple[dict[str, Any], Path]) -> None:
    haze = _without(preflight_found[0], "haze")
    assert haze["verdict"] == "not needed"
    assert _holds(haze["mean_bias"], math.exp(THIN) - 1)
    assert haze["samples"] is not None


def test_what_is_taken_is_as_bright(preflight_found: tuple[dict[str, Any], Path], tmp_path: Path) -> None:
    found, folder = preflight_found
    taken = json.loads((folder / "taken.json").read_text())
    kept = {name for surface in taken["surfaces"] for name in surface.get("interior", {}).get("media", [])}
    assert "smoke" in kept
    assert ("haze" in kept) == ('without medium "haze"' not in found["chosen"]["without"])
    render_scene(LocalRender(folder / "taken.json", [tmp_path / "image.exr"], 32, 32, 64, 2))
    image = Image.read(tmp_path / "image.exr")
    error = float(np.sqrt(np.sum(image.y_error.astype(float) ** 2))) / image.y.size
    expected = 100 * math.exp(-THICK - THIN)
    assert abs(image.y.mean() - expected) < 4 * error + 2 * (math.exp(THIN) - 1) * expected


def test_the_chart_names_the_models(preflight_found: tuple[dict[str, Any], Path]) -> None:
    chart = (preflight_found[1] / "chart.svg").read_text()
    assert "the full model" in chart
    assert "without medium &quot;haze&quot;" in chart or 'without medium "haze"' in chart


def test_files_elsewhere_are_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    scene = _scene(tmp_path / "inner")
    command = [
        sys.executable,
        "-m",
        "nocturne_client",
        "preflight",
        str(scene),
        "--take",
        str(tmp_path / "no" / "a.json"),
    ]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=300)
    assert done.returncode == 2
    assert "no such folder" in done.stderr


def test_a_target_of_more_than_all_is_refused(tmp_path: Path) -> None:
    with pytest.raises(typer.BadParameter, match="less than 100 %"):
        preflight(_scene(tmp_path), error="200%")
