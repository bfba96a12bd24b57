"""Scene documents for these tests."""

import json
from pathlib import Path
from typing import Any

from tests.accuracy.tracing import Document

_CORNELL = Path(__file__).parents[2] / "scenes" / "cornell" / "scene.json"


def cornell(tracing: Document, **sensor: Any) -> Document:
    """The Cornell box, with other ways to trace it and another sensor.

    The field of view is 36 degrees instead of 39.3: no pixel looks past the box's front edges, where light
    comes through slivers of a pixel, so seldom that sums are far from normal.
    """
    document: Document = json.loads(_CORNELL.read_text())
    document["sensor"] |= {"vertical_field_of_view_degrees": 36.0, **sensor}
    document["tracing"] = tracing
    return document


def furnace(albedo: float, radiance: float) -> Document:
    """A closed box, seen from inside; all its walls scatter and emit. Traced as by default."""
    walls = [
        # Corner and edges: the normal edge_u x edge_v points inwards.
        ([0, 0, 0], [0, 1, 0], [0, 0, 1]),
        ([1, 0, 0], [0, 0, 1], [0, 1, 0]),
        ([0, 0, 0], [0, 0, 1], [1, 0, 0]),
        ([0, 1, 0], [1, 0, 0], [0, 0, 1]),
        ([0, 0, 0], [1, 0, 0], [0, 1, 0]),
        ([0, 0, 1], [0, 1, 0], [1, 0, 0]),
    ]
    return {
        "nocturne": 1,
        "spectra": {"glow": radiance, "wall": albedo},
        "kernels": {"wall": {"type": "lambertian", "reflectance": "wall"}},
        "sensor": {
            "type": "pinhole",
            "position": [0.3, 0.4, 0.2],
            "look_at": [0.7, 0.5, 0.8],
            "vertical_field_of_view_degrees": 70,
        },
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v},
                "kernel": "wall",
                "luminaire": {"radiance": "glow"},
            }
            for corner, edge_u, edge_v in walls
        ],
    }
