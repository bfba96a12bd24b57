"""A film that measures illuminance, against a camera that looks at a white plane in its place: variance of
pixels times processor time, under the Sun, a lamp in a room, and a sky."""

import tempfile
from math import pi
from pathlib import Path

import numpy as np

from bench.programs import Traced, trace
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film

_EDGE = 16
_HEIGHT = 0.8
_AIM = 1.2


def run(quick: bool) -> Figures:
    """Several images of each by both."""
    seeds, samples = (4, 64) if quick else (16, 1024)
    return {"seeds": seeds, "samples": samples} | {
        name: {"ratio": significant(_ratio(light, seeds, samples))} for name, light in _LIGHTS.items()
    }


def rows(figures: Figures) -> list[Row]:
    """One for each light."""
    return [
        Row(
            f"meter under {name}: variance x time, of a camera that looks at a white plane there",
            f"{figures[name]['ratio']:.3g}",
            f"at most {_AIM:g}",
        )
        for name in _LIGHTS
    ]


def _quad(
    corner: list[float], u: list[float], v: list[float], reflectance: float, **more: object
) -> Document:
    shape = {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v}
    return {"shape": shape, "kernel": {"type": "lambertian", "reflectance": reflectance}, **more}


_ROOM = [
    _quad([-3, 0, -3], [0, 0, 6], [6, 0, 0], 0.2),
    _quad([-3, 2.8, -3], [6, 0, 0], [0, 0, 6], 0.7),
    _quad([-3, 0, -3], [6, 0, 0], [0, 2.8, 0], 0.5),
    _quad([-3, 0, 3], [0, 2.8, 0], [6, 0, 0], 0.5),
    _quad([-3, 0, -3], [0, 2.8, 0], [0, 0, 6], 0.5),
    _quad([3, 0, -3], [0, 0, 6], [0, 2.8, 0], 0.5),
]
_LAMP = _quad([-0.3, 2.79, -0.3], [0.6, 0, 0], [0, 0, 0.6], 0.0, luminaire={"radiance": 10.0})
_GROUND = _quad([-5, 0, -5], [0, 0, 10], [10, 0, 0], 0.2)
_LIGHTS: dict[str, Document] = {
    "the Sun": {"surfaces": [_GROUND], "distant": [{"direction": [0.5, 0.7, 0.2], "radiance": 1e4}]},
    "a lamp in a room": {"surfaces": [*_ROOM, _LAMP]},
    "an overcast sky": {"surfaces": [_GROUND], "environment": {"cie": 5, "illuminance": 1e4}},
}


def _ratio(light: Document, seeds: int, samples: int) -> float:
    meter = {"type": "irradiance_meter", "position": [0, _HEIGHT, 0], "normal": [0, 1, 0], "height": 1}
    plane = _quad([-0.5, _HEIGHT, -0.5], [0, 0, 1], [1, 0, 0], 1.0)
    camera = {
        "type": "orthographic",
        "position": [0, 2, 0],
        "look_at": [0, 0, 0],
        "up": [0, 0, 1],
        "height": 1,
    }
    products = []
    for sensor, more, factor in ((meter, [], 1.0), (camera, [plane], pi)):
        document = light | {"nocturne": 1, "sensor": sensor, "surfaces": [*light["surfaces"], *more]}
        found = [_traced(document, seed, samples) for seed in range(seeds)]
        images = factor * np.array([each.xyz[..., 1] for each in found])
        cpu_s = sum(each.tracing_cpu_s for each in found)
        products.append(float(images.var(axis=0, ddof=1).mean()) * cpu_s)
    return products[0] / products[1]


def _traced(document: Document, seed: int, samples: int) -> Traced:
    tracing = {"direction": "adjoint", "sharing": 1, "seed": seed}
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        compiled = compile_film(document | {"tracing": tracing}, place, _EDGE, _EDGE, samples, place / "out")
        return trace(compiled, 1)
