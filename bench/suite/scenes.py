"""The scenes of the suite, their films, and who makes their references."""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

from bench.peer.contenders import FilmSize
from bench.peer.scenes import spheres
from bench.scenes import Document, example

Tracing = dict[str, Any]

_DEFAULT: Tracing = {}
_MIXTURE: Tracing = {"estimator": "mixture"}
_KERNEL: Tracing = {
    "estimator": "mixture",
    "mixture": {"kernel": 1.0, "luminaires": 0.0, "environment": 0.0},
}
_FORWARD: Tracing = {"direction": "forward"}
AIMED: Tracing = {"direction": "forward", "aimed_emission": 0.9}
_ADJOINT: Tracing = {"direction": "adjoint"}
_BOTH: Tracing = {"direction": "both"}
OPENINGS: Tracing = {
    "direction": "adjoint",
    "estimator": "mixture",
    "mixture": {"kernel": 0.5, "important": 0.5},
}


@dataclass(frozen=True)
class SuiteScene:
    """A scene, and the two methods by which its reference is made and checked."""

    document: Callable[[Path], Document]
    """Gives the document; files that it names go into the folder."""
    film: FilmSize
    reference: Tracing
    check: Tracing | None
    """None: the path tracer, which shares nothing with the tracing loop."""
    peers_particles: bool = False
    """Whether the peer does best by its particle tracer."""


def _example(name: str) -> Callable[[Path], Document]:
    return lambda folder: example(name, folder)


def caustic(folder: Path) -> Document:
    """Light of a small lamp, gathered by a ball of glass on a film behind it.

    One index, that of N-BK7 at 587.6 nm, so that renderers without dispersion can show it. Important is a
    ball around film and glass.
    """
    del folder
    return {
        "nocturne": 1,
        "sensor": {
            "type": "irradiance_meter",
            "position": [0, 0, 0],
            "normal": [0, 0, 1],
            "up": [0, 1, 0],
            "height": 0.12,
        },
        "surfaces": [
            {
                "shape": {"type": "sphere", "centre": [0, 0, 0.09], "radius": 0.03},
                "kernel": {"type": "dielectric", "index": 1.5168},
            },
            {
                "shape": {"type": "sphere", "centre": [0.1, 0, 0.6], "radius": 0.01},
                "kernel": {"type": "lambertian", "reflectance": 0},
                "luminaire": {"radiance": {"blackbody": 5500, "luminance": 1e7}},
            },
        ],
        "important_directions": [
            {"shape": {"type": "sphere", "centre": [0, 0, 0.045], "radius": 0.1}},
        ],
    }


def instances(folder: Path) -> Document:
    """A thousand copies of a ball on a foot, by a grid, under a lamp and a weak sky."""
    del folder
    foot = {"type": "box", "minimum": [-0.2, 0, -0.2], "maximum": [0.2, 0.3, 0.2]}
    group = [
        {"shape": foot, "kernel": {"type": "lambertian", "reflectance": 0.5}},
        {
            "shape": {"type": "sphere", "centre": [0, 0.55, 0], "radius": 0.25},
            "kernel": {"type": "coated_diffuse", "index": 1.5, "reflectance": 0.6},
        },
    ]
    copies = [
        {
            "group": "ball",
            "rotate": {"axis": [0, 1, 0], "degrees": (37 * number) % 360},
            "translate": [number % 40 - 20.0, 0.0, number // 40 * 1.0],
        }
        for number in range(1000)
    ]
    floor = {"type": "quad", "corner": [-30, 0, -10], "edge_u": [0, 0, 60], "edge_v": [60, 0, 0]}
    lamp = {"type": "quad", "corner": [-8, 12, 2], "edge_u": [8, 0, 0], "edge_v": [0, 0, 8]}
    return {
        "nocturne": 1,
        "groups": {"ball": group},
        "instances": copies,
        "sensor": {
            "type": "pinhole",
            "position": [0, 4, -6],
            "look_at": [0, 0, 5],
            "vertical_field_of_view_degrees": 45,
        },
        "surfaces": [
            {"shape": floor, "kernel": {"type": "lambertian", "reflectance": 0.4}},
            {
                "shape": lamp,
                "kernel": {"type": "lambertian", "reflectance": 0},
                "luminaire": {"radiance": {"illuminant": "A", "luminance": 20000}},
            },
        ],
        "environment": {"radiance": {"illuminant": "D65", "luminance": 100 / pi}},
    }


SCENES: dict[str, SuiteScene] = {
    "cornell": SuiteScene(_example("cornell"), FilmSize(24, 24), _DEFAULT, None),
    "glossy spheres": SuiteScene(spheres, FilmSize(32, 24), _DEFAULT, None),
    "reflector": SuiteScene(_example("reflector"), FilmSize(24, 16), _BOTH, OPENINGS, peers_particles=True),
    "headlight in fog": SuiteScene(_example("headlight"), FilmSize(24, 16), _BOTH, _ADJOINT),
    "smoke": SuiteScene(_example("smoke"), FilmSize(16, 20), _DEFAULT, _MIXTURE),
    "sky": SuiteScene(_example("sky"), FilmSize(32, 16), _DEFAULT, _MIXTURE),
    "subsurface": SuiteScene(_example("subsurface"), FilmSize(32, 16), _DEFAULT, _KERNEL),
    "prism": SuiteScene(_example("both_directions"), FilmSize(16, 16), _FORWARD, _DEFAULT),
    "caustic": SuiteScene(caustic, FilmSize(24, 24), AIMED, _DEFAULT),
    "colour chart": SuiteScene(_example("colour_chart"), FilmSize(24, 16), _DEFAULT, None),
    "instances": SuiteScene(instances, FilmSize(24, 16), _DEFAULT, None),
}
"""By name, in the order of the pages. Films are small, so that references are."""
