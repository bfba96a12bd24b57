"""Scenes that both renderers can show, as documents of ours."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO

from bench.programs import Channel
from bench.scenes import Document, cornell

CHART = "BabelColor Average"
"""Mean spectral reflectances of 30 ColorCheckers, measured by D. Pascale (BabelColor)."""

_COLUMNS, _ROWS = 6, 4


@dataclass(frozen=True)
class Scene:
    """A document, what to show of it, and its files."""

    write: Callable[[Path], Document]
    """Gives the document; files that it names go into the folder."""
    width: int
    height: int


SKY = "sky.exr"
_SKY_WIDTH, _SKY_HEIGHT = 1024, 512
# Luminances relative to the sky's at the zenith. The spot is many texels wide, so that both renderers, of
# which only one interpolates between texels, show the same sky.
_GROUND, _HORIZON, _SPOT = 0.1, 0.5, 2000.0
_SPOT_SIGMA_DEGREES = 1.5
_SPOT_DIRECTION = (-0.5, 0.65, -0.55)


def scenes() -> dict[str, Scene]:
    """By name."""
    return {
        "cornell": Scene(lambda _: cornell(), 128, 128),
        "chart": Scene(lambda _: chart(), 96, 64),
        "spheres": Scene(spheres, 128, 96),
    }


def chart() -> Document:
    """24 Lambertian patches that fill the image, under a uniform sky of D65."""
    # Late: it takes a second, and warns that Matplotlib is not there.
    import colour

    patches = colour.SDS_COLOURCHECKERS[CHART]
    surfaces = [
        {
            "shape": {
                "type": "quad",
                "corner": [column - _COLUMNS / 2, _ROWS / 2 - 1 - row, 0],
                "edge_u": [1, 0, 0],
                "edge_v": [0, 1, 0],
            },
            "kernel": {"type": "lambertian", "reflectance": {"table": _table(patch)}},
        }
        for (row, column), patch in zip(np.ndindex(_ROWS, _COLUMNS), patches.values(), strict=True)
    ]
    return {
        "nocturne": 1,
        "sensor": {
            "type": "orthographic",
            "position": [0, 0, 5],
            "look_at": [0, 0, 0],
            "up": [0, 1, 0],
            "height": _ROWS,
        },
        "surfaces": surfaces,
        "environment": {"radiance": {"illuminant": "D65", "luminance": 1000}},
    }


def spheres(folder: Path) -> Document:
    """Three rough metal balls and a plastic one on a grey floor, under the sky of `write_sky`."""
    write_sky(folder / SKY)
    kernels: list[dict[str, Any]] = [
        {"type": "conductor", "index": "Cu", "roughness": 0.05},
        {"type": "conductor", "index": "Au", "roughness": 0.1},
        {"type": "conductor", "index": "Al", "roughness": 0.2},
        {
            "type": "coated_diffuse",
            "index": 1.5,
            "reflectance": {"table": [[400, 0.05], [600, 0.4], [700, 0.6]]},
        },
    ]
    balls = [
        {"shape": {"type": "sphere", "centre": [2.2 * place - 3.3, 1, 0], "radius": 1}, "kernel": kernel}
        for place, kernel in enumerate(kernels)
    ]
    floor = {
        "shape": {"type": "quad", "corner": [-8, 0, 8], "edge_u": [16, 0, 0], "edge_v": [0, 0, -16]},
        "kernel": {"type": "lambertian", "reflectance": 0.5},
    }
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 3, -9],
            "look_at": [0, 0.9, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 45,
        },
        "surfaces": [floor, *balls],
        "environment": {"asset": SKY, "luminance": 1000, "up": [0, 1, 0], "forward": [0, 0, 1]},
    }


def write_sky(path: Path) -> None:
    """A sky with a bright, blurred sun.

    Grey, so that its spectrum is D65 for both: each makes coloured texels into spectra in its own way.
    """
    polar = (np.arange(_SKY_HEIGHT) + 0.5) * math.pi / _SKY_HEIGHT
    turn = (np.arange(_SKY_WIDTH) + 0.5) * 2 * math.pi / _SKY_WIDTH
    sine, up = np.sin(polar)[:, None], np.cos(polar)[:, None]
    # In the picture's middle, at half a turn, is +z; to the right of it is -x.
    towards = np.stack(np.broadcast_arrays(sine * np.sin(turn), up, -sine * np.cos(turn)), axis=-1)
    spot = np.array(_SPOT_DIRECTION) / np.linalg.norm(_SPOT_DIRECTION)
    angle = np.arccos(np.clip(towards @ spot, -1, 1))
    sky = _HORIZON + (1 - _HORIZON) * np.maximum(up, 0)
    # Smooth over some degrees about the horizon, for the same reason as the spot is wide.
    clear = 0.5 + 0.5 * np.tanh(up / 0.05)
    grey: Channel = _GROUND + (sky - _GROUND) * clear
    grey = grey + _SPOT * np.exp(-0.5 * (angle / math.radians(_SPOT_SIGMA_DEGREES)) ** 2)
    write_grey(path, grey)


def write_grey(path: Path, grey: Channel) -> None:
    """Writes a picture with three equal channels."""
    image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(grey.shape[1], grey.shape[0], 3, OpenImageIO.FLOAT))
    image.set_pixels(OpenImageIO.ROI(), np.repeat(grey[..., None], 3, axis=2).astype(np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def _table(patch: Any) -> list[list[float]]:
    return [[float(at), float(value)] for at, value in zip(patch.wavelengths, patch.values, strict=True)]
