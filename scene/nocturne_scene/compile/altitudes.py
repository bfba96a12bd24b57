"""Densities that depend on altitude, above a plane or a planet."""

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.document.media import AbovePlane, AboveSphere
from nocturne_scene.meshes.similarity import Similarity


def above(ground: AbovePlane | AboveSphere, frame: Similarity) -> scene_pb2.AltitudeDensity:
    """Return a density without its profile."""
    if isinstance(ground, AboveSphere):
        return above_sphere(np.array(ground.centre), ground.radius, frame)
    base = frame.points(np.array(ground.point))
    return scene_pb2.AltitudeDensity(base=vector(base), up=vector(unit(np.array(ground.up))))


def above_sphere(centre: NDArray[np.float64], radius: float, frame: Similarity) -> scene_pb2.AltitudeDensity:
    """Return the same, from the point of the ground that is below the compiled scene's origin."""
    centre = frame.points(centre)
    up = -unit(centre) if np.any(centre) else np.array([0.0, 1.0, 0.0])
    return scene_pb2.AltitudeDensity(base=vector(centre + radius * up), up=vector(up), radius=radius)
