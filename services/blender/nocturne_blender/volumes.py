"""Volumes of OpenVDB files: a box without a surface, with a medium whose density is a grid."""

from itertools import product
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .files import Files, ply
from .findings import Findings

Json = Any

# Around the voxels that a volume says it has: half of one on each side is filled, too.
_WIDER = 1.02
_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def surface(
    shown: Any, where: Json | None, fields: Json, document: Json, files: Files, findings: Findings
) -> Json:
    """The surface around a volume; None where it is not supported.

    `where`: its Placement; `fields`: those of its material.
    """
    thing, name = shown.thing, shown.thing.name
    media = fields.get("interior", {}).get("media", [])
    if where is None or not media:
        findings.lost(name, "no support for a volume that is stretched, or without a shader; left out")
        return None
    grids = thing.data.grids
    grids.load()
    names = [grid.name for grid in grids if grid.data_type == "FLOAT"]
    try:
        content = Path(bpy.path.abspath(thing.data.filepath)).read_bytes()
    except OSError:
        names = []
    if not names:
        findings.lost(name, "its file can't be read, or has no grid of numbers; left out")
        return None
    medium = dict(document["media"][media[0]])
    factor = medium.get("density", 1.0)
    if thing.data.render.space == "OBJECT":
        factor /= where.get("scale", 1.0)
    grid = "density" if "density" in names else names[0]
    medium["density"] = {"asset": files.add(content), "grid": grid, "factor": factor} | where
    own = f"{media[0]} of volume {len(document['media']) + 1}"
    document["media"][own] = medium
    return {
        "shape": {"type": "mesh", "asset": files.add(_box(shown)), "format": "ply", "smooth": False},
        "kernel": {"type": "null"},
        "interior": {"media": [own]},
    }


def _box(shown: Any) -> bytes:
    """The box around its voxels, where it stands."""
    corners = np.array(shown.thing.bound_box, np.float32)
    middle, half = (corners.min(axis=0) + corners.max(axis=0)) / 2, np.ptp(corners, axis=0) / 2 * _WIDER
    box = middle + half * np.array(list(product((-1, 1), repeat=3)), np.float32)
    matrix = np.array(shown.matrix, np.float32)
    triangles = [(a, b, c) for face in _FACES for a, b, c in (face[:3], (face[0], face[2], face[3]))]
    return ply((box @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32), np.array(triangles, np.int32))
