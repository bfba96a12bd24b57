"""A scene with two fogs, and documents as a pilot has them: files by digest."""

from typing import Any

import pytest

Document = dict[str, Any]


@pytest.fixture
def document() -> Document:
    """Surface 0 is a lamp, 1 bounds both fogs, 2 is glass with fog in it."""
    return {
        "nocturne": 1,
        "media": {"fog": {"scattering": 0.1}, "haze": {"absorption": 0.001}, "spare": {"scattering": 1}},
        "kernels": {"glass": {"type": "dielectric", "index": "N-BK7"}},
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, 0],
            "look_at": [0, 0, 1],
            "vertical_field_of_view_degrees": 40,
        },
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": [0, 3, 3], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]},
                "kernel": {"type": "lambertian", "reflectance": 0.5},
                "luminaire": {"radiance": {"blackbody": 3000}},
            },
            {
                "shape": {"type": "box", "minimum": [-1, -1, 1], "maximum": [1, 1, 4]},
                "interior": {"media": ["fog", "haze"]},
            },
            {
                "shape": {"type": "sphere", "centre": [0, 0, 6], "radius": 1},
                "kernel": "glass",
                "interior": {"media": ["fog"]},
            },
        ],
    }
