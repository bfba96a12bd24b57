"""Writes the reflector and the cover of this scene's lamp next to itself, or into a folder.

The reflector is a paraboloid with its focus at the origin, open towards +z. The cover is a disc of glass
whose front has upright ribs, which spread the beam to the sides. Positions are rounded to a micrometre.
"""

import sys
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

FOCAL_LENGTH = 0.025  # m
OPENING = 0.07  # m, radius
COVER_RADIUS, COVER_BACK, COVER_FRONT = 0.075, 0.03, 0.033  # m
RIB, RIB_HEIGHT = 0.01, 0.0009  # m, from rib to rib, and from valley to crest
RINGS, SECTORS = 60, 360

Points = NDArray[np.float64]


def main(folder: Path) -> None:
    """Write reflector.ply and cover.ply into `folder`."""
    for name, mesh in (("reflector", reflector()), ("cover", cover())):
        mesh.vertices = np.round(mesh.vertices, 6)
        mesh.export(folder / f"{name}.ply")


def reflector() -> trimesh.Trimesh:
    """Its normals point to where the lamp is."""
    points = _disc(OPENING)
    points[:, 2] = (points[:, 0] ** 2 + points[:, 1] ** 2) / (4 * FOCAL_LENGTH) - FOCAL_LENGTH
    return trimesh.Trimesh(points, _faces(), process=False)


def cover() -> trimesh.Trimesh:
    """A closed body."""
    back, front = _disc(COVER_RADIUS), _disc(COVER_RADIUS)
    back[:, 2] = COVER_BACK
    inside = np.hypot(front[:, 0], front[:, 1]) < 0.99 * COVER_RADIUS
    ribs = 0.5 * RIB_HEIGHT * (1 + np.cos(2 * np.pi * front[:, 0] / RIB))
    front[:, 2] = COVER_FRONT + np.where(inside, ribs, 0.0)
    count = len(back)
    rim = count - SECTORS + np.arange(SECTORS)
    following = np.roll(rim, -1)
    edge = np.concatenate(
        [
            np.stack([rim, following, following + count], axis=1),
            np.stack([rim, following + count, rim + count], axis=1),
        ]
    )
    faces = np.concatenate([_faces()[:, ::-1], _faces() + count, edge])
    return trimesh.Trimesh(np.concatenate([back, front]), faces, process=False)


def _disc(radius: float) -> Points:
    """Vertices of a disc: the middle, then ring by ring."""
    angle = 2 * np.pi * np.arange(SECTORS) / SECTORS
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(SECTORS)], axis=1)
    rings = [radius * (i + 1) / RINGS * ring for i in range(RINGS)]
    return np.concatenate([np.zeros((1, 3)), *rings])


def _faces() -> NDArray[np.int64]:
    """Triangles of the disc, seen counter-clockwise from +z."""
    sector = np.arange(SECTORS)
    following = (sector + 1) % SECTORS
    middle = np.stack([np.zeros_like(sector), 1 + sector, 1 + following], axis=1)
    parts = [middle]
    for ring in range(RINGS - 1):
        inner, outer = 1 + ring * SECTORS, 1 + (ring + 1) * SECTORS
        a, b, c, d = inner + sector, inner + following, outer + sector, outer + following
        parts += [np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)]
    return np.concatenate(parts)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
