"""`nocturne light-parts`: direct and indirect light of an image, against a furnace, where both are known."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from nocturne_client.cli.app import app
from typer.testing import CliRunner

REFLECTANCE = 0.5
FURNACE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 90,
    },
    "surfaces": [
        {
            "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1},
            "kernel": {"type": "lambertian", "reflectance": REFLECTANCE},
            "luminaire": {"radiance": 1, "two_sided": True},
        }
    ],
}
"""A closed sphere that glows by L everywhere: L + r L straight, and L / (1 - r) in all."""


def run(*words: str | Path) -> str:
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result.output


def channels(path: Path) -> dict[str, Any]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


def test_both_parts_are_those_of_a_furnace(tmp_path: Path) -> None:
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(FURNACE))
    film = ("--width", "8", "--height", "8", "--samples", "256", "--threads", "2")
    run("render", scene, "-o", tmp_path / "all.exr", *film)
    one = ("--set", "tracing.maximum_depth=1")
    run("render", scene, "-o", tmp_path / "direct.exr", *film, *one)
    run("light-parts", tmp_path / "all.exr", tmp_path / "direct.exr", "-o", tmp_path / "parts.exr")
    parts, whole = channels(tmp_path / "parts.exr"), channels(tmp_path / "all.exr")
    assert np.allclose(parts["direct.Y"] + parts["indirect.Y"], whole["Y"], rtol=1e-6)
    assert np.allclose(parts["direct.G"] + parts["indirect.G"], whole["G"], rtol=1e-4)
    direct = parts["direct.Y"].mean()
    expected = REFLECTANCE**2 / (1 - REFLECTANCE) / (1 + REFLECTANCE)
    error = np.sqrt((parts["indirect.Y.stderr"] ** 2).mean() / 64) / direct
    assert 0.0 < error < 0.01
    assert abs(parts["indirect.Y"].mean() / direct - expected) < 4 * error


def test_another_film_is_refused(tmp_path: Path) -> None:
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(FURNACE))
    for size in "45":
        film = ("--width", size, "--height", "4", "--samples", "4")
        run("render", scene, "-o", tmp_path / f"{size}.exr", *film)
    words = [str(tmp_path / "4.exr"), str(tmp_path / "5.exr"), "-o", str(tmp_path / "x.exr")]
    result = CliRunner().invoke(app, ["light-parts", *words])
    [problem] = getattr(result.exception, "problems", [])
    assert "has not the film of" in problem.message
    assert not (tmp_path / "x.exr").exists()
