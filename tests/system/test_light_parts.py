"""Direct and indirect light as channels: by closed forms, and by a render of direct light alone."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from nocturne_client.cli.app import app
from typer.testing import CliRunner

pytestmark = pytest.mark.system

Scene = dict[str, Any]
Channels = dict[str, Any]

REFLECTANCE = 0.5
CAMERA = {
    "type": "pinhole",
    "position": [0, 0, 0],
    "look_at": [0, 0, -1],
    "vertical_field_of_view_degrees": 60,
}
FURNACE: Scene = {
    "nocturne": 1,
    "sensor": CAMERA,
    "surfaces": [
        {
            "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1},
            "kernel": {"type": "lambertian", "reflectance": REFLECTANCE},
            "luminaire": {"radiance": 1, "two_sided": True},
        }
    ],
}
"""A closed sphere that glows by L everywhere: L + r L straight, and L / (1 - r) in all."""


def quad(corner: list[float], u: list[float], v: list[float], **more: Any) -> Scene:
    return {"shape": {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v}, **more}


def lambertian(reflectance: float) -> Scene:
    return {"type": "lambertian", "reflectance": reflectance}


LAMP = quad([-0.5, 1, -2.5], [1, 0, 0], [0, 0, 1], kernel=lambertian(0.0), luminaire={"radiance": 5})
WALL = quad([-2, -2, -3], [4, 0, 0], [0, 4, 0], kernel=lambertian(0.7))
FLOOR = quad([-2, -1, -3], [0, 0, 3], [4, 0, 0], kernel=lambertian(0.6))
PANE = quad(
    [-0.6, -1, -1.5],
    [1.2, 0, 0],
    [0, 2, 0],
    kernel={"type": "mask", "kernel": lambertian(0.4), "opacity": 0.5},
)
BALL = {
    "shape": {"type": "sphere", "centre": [0.5, -0.7, -2], "radius": 0.3},
    "kernel": {"type": "dielectric", "index": 1.5},
}


HAZE = {
    "shape": {"type": "box", "minimum": [-1.9, -0.9, -2.9], "maximum": [1.9, 0.9, -0.4]},
    "interior": {"media": ["haze"]},
}
CRYSTAL = {
    "shape": {"type": "sphere", "centre": [-0.6, -0.6, -1.8], "radius": 0.25},
    "kernel": {"type": "dielectric", "index": {"cauchy": [1.5, 0.02]}},
}
"""It refracts colours into different directions, so that photons of a group separate."""


def render(folder: Path, surfaces: list[Scene], *layers: str, **tracing: Any) -> Channels:
    media = {"haze": {"scattering": 0.3, "absorption": 0.1}}
    document = {"nocturne": 1, "sensor": CAMERA, "media": media, "surfaces": surfaces, "tracing": tracing}
    return render_document(folder, document, *layers)


def render_document(folder: Path, document: Scene, *layers: str, samples: int = 64) -> Channels:
    scene, image = folder / "scene.json", folder / "image.exr"
    scene.write_text(json.dumps(document))
    film = ("--width", "16", "--height", "16", "--samples", f"{samples}", "--threads", "2")
    asked = ("--layers", ",".join(layers)) if layers else ()
    result = CliRunner().invoke(app, ["render", str(scene), "-o", str(image), *film, *asked])
    assert result.exit_code == 0, result.output
    with OpenEXR.File(str(image), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


def test_both_parts_are_those_of_a_furnace(tmp_path: Path) -> None:
    found = render_document(tmp_path, FURNACE, "direct", samples=256)
    for name in "XYZ":
        np.testing.assert_allclose(
            found[f"direct.{name}"] + found[f"indirect.{name}"], found[name], rtol=2e-6
        )
    ratio = found["indirect.Y"].mean() / found["direct.Y"].mean()
    error = np.sqrt((found["indirect.Y.stderr"] ** 2).mean() / found["Y"].size) / found["direct.Y"].mean()
    assert 0.0 < error < 0.01
    assert abs(ratio - REFLECTANCE**2 / (1 - REFLECTANCE) / (1 + REFLECTANCE)) < 4 * error


def test_a_lamp_over_a_plane_has_no_indirect_light(tmp_path: Path) -> None:
    found = render(tmp_path, [LAMP, FLOOR], "indirect")
    assert found["direct.Y"].max() > 0.0
    assert not found["indirect.Y"].any()


@pytest.mark.parametrize("more", [[], [HAZE, CRYSTAL]], ids=["surfaces", "haze and dispersion"])
@pytest.mark.parametrize(
    "tracing",
    [
        {"direction": "adjoint", "sharing": 1},
        {"direction": "adjoint", "sharing": 16},
        {"direction": "both", "sharing": 1},
        {"direction": "both", "sharing": 16},
        {"direction": "adjoint", "sharing": 1, "estimator": "mixture"},
    ],
    ids=lambda tracing: " ".join(str(each) for each in tracing.values()),
)
def test_the_direct_part_is_a_render_of_direct_light(
    tmp_path: Path, tracing: Scene, more: list[Scene]
) -> None:
    room = [LAMP, WALL, FLOOR, PANE, BALL, *more]
    found = render(tmp_path, room, "direct", "indirect", **tracing)
    alone = render(tmp_path, room, maximum_depth=1, **tracing)
    for name in "XYZ":
        np.testing.assert_allclose(
            found[f"direct.{name}"], alone[name], rtol=1e-5, atol=1e-6 * alone[name].max()
        )
        parts = found[f"direct.{name}"] + found[f"indirect.{name}"]
        np.testing.assert_allclose(parts, found[name], rtol=2e-6, atol=1e-6 * alone[name].max())
    assert found["indirect.Y"].max() > 0.0


def test_the_image_has_the_same_bits_with_and_without(tmp_path: Path) -> None:
    without = render(tmp_path, [LAMP, WALL, FLOOR])
    beside = render(tmp_path, [LAMP, WALL, FLOOR], "direct")
    for name, values in without.items():
        np.testing.assert_array_equal(beside[name], values, err_msg=name)
