"""Sensors of scenes whose files have none."""

import numpy as np

from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json


def panorama_inside(extent: Extent, findings: Findings) -> Json:
    """Of a room: all directions from its middle."""
    findings.note("", "the file has no camera; a panorama looks from the middle of the scene")
    middle = np.zeros(3) if extent.is_empty else 0.5 * (extent.lowest + extent.highest)
    x, y, z = (float(each) for each in middle)
    return {"type": "panorama", "position": [x, y, z], "look_at": [x, y, z - 1.0]}
