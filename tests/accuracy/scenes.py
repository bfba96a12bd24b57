"""Scene documents for these tests."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.accuracy.tracing import Document

_CORNELL = Path(__file__).parents[2] / "examples" / "cornell" / "scene.json"


def cornell(tracing: Document, **sensor: Any) -> Document:
    """The Cornell box, with other methods of tracing and another sensor.

    The field of view is 36 degrees instead of 39.3: no pixel looks past the box's front edges, where light
    comes through slivers of a pixel, so seldom that sums are far from normal.
    """
    document: Document = json.loads(_CORNELL.read_text())
    document["sensor"] |= {"vertical_field_of_view_degrees": 36.0, **sensor}
    document["tracing"] = tracing
    return document


def bowl(radius: float, opening: float, rings: int, segments: int) -> Document:
    """A part of a sphere around the origin, up to the angle `opening` (radians) from -z, seen from inside."""
    tilts = np.linspace(0.0, opening, rings + 1)[1:]
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles), np.ones(segments)])
    vertices = [[0.0, 0.0, -radius]]
    for tilt in tilts:
        vertices += (radius * around * [np.sin(tilt), np.sin(tilt), -np.cos(tilt)]).tolist()
    after = [(i + 1) % segments for i in range(segments)]
    triangles = [[0, 1 + i, 1 + after[i]] for i in range(segments)]
    for row in range(rings - 1):
        a, b = 1 + row * segments, 1 + (row + 1) * segments
        for i in range(segments):
            triangles += [[a + i, b + i, b + after[i]], [a + i, b + after[i], a + after[i]]]
    return {"type": "mesh", "vertices": vertices, "triangles": triangles}
