"""A room with a window: by the sky, the Sun, a lamp; a pane, a curtain or haze before the lit surface."""

from typing import Any

from nocturne_scene.validation.documents import diffuse, quad, surface

from tests.accuracy.tracing import Document

_CAMERA = {
    "type": "pinhole",
    "position": [0.6, 0.6, 1.5],
    "look_at": [3, 3, 0.5],
    "up": [0, 0, 1],
    "vertical_field_of_view_degrees": 70,
}
_METER = {"type": "irradiance_meter", "position": [2, 2, 0.8], "normal": [0, 0, 1], "height": 1}
_SKY = {"cie": 12, "sun": [1, -1, 1], "up": [0, 0, 1], "illuminance": 10000}
_SUN = {"direction": [0.3, -1, 0.8], "angular_diameter_degrees": 5, "irradiance": 3.0}
_PANE = surface(quad([1.2, 0, 1], [0, 0, 1.4], [1.6, 0, 0]), {"type": "thin_pane", "index": 1.5})
_HAZE = {
    "shape": {"type": "box", "minimum": [-0.5, -1, -0.5], "maximum": [4.5, 4.5, 3.5]},
    "interior": {"media": ["haze"]},
}
_CURTAIN = surface(
    quad([1.2, 0.1, 1], [0, 0, 1.4], [1.6, 0, 0]),
    {"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": 0.5},
)


def _room(*surfaces: Document, **given: Any) -> Document:
    """Of 4 m x 4 m x 3 m with a window."""
    walls = [
        quad([0, 0, 0], [4, 0, 0], [0, 4, 0]),
        quad([0, 0, 3], [0, 4, 0], [4, 0, 0]),
        quad([0, 4, 0], [4, 0, 0], [0, 0, 3]),
        quad([0, 0, 0], [0, 4, 0], [0, 0, 3]),
        quad([4, 0, 0], [0, 0, 3], [0, 4, 0]),
        quad([0, 0, 0], [0, 0, 1], [4, 0, 0]),
        quad([0, 0, 2.4], [0, 0, 0.6], [4, 0, 0]),
        quad([0, 0, 1], [0, 0, 1.4], [1.2, 0, 0]),
        quad([2.8, 0, 1], [0, 0, 1.4], [1.2, 0, 0]),
    ]
    return {
        "nocturne": 1,
        "sensor": _CAMERA,
        "environment": _SKY,
        "surfaces": [*(surface(each, diffuse(0.5)) for each in walls), *surfaces],
        **given,
    }


SCENES = {
    "sky": _room(),
    "even sky": _room(environment={"radiance": 1.0}),
    "sky and Sun": _room(distant=[_SUN]),
    "pane": _room(_PANE),
    "haze": _room(_HAZE, media={"haze": {"scattering": 0.05, "absorption": 0.02}}),
    "curtain": _room(_CURTAIN),
    "film": _room(sensor=_METER),
    "lamp": _room(surface({"type": "sphere", "centre": [2, 3, 2.5], "radius": 0.2}, diffuse(0.2), 1e3)),
}
