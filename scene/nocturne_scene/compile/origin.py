"""Where the compiled scene has its origin: near what the sensor sees, however far out the document's is.

The tracer's coordinates have 24 bits: at 1000 km from the origin they are 6 cm apart. Everything is placed in
float64 before, so it can be moved where they are fine.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.shapes import MediumBox, Sphere
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.similarity import IDENTITY, Similarity

_STEP = 1024.0
"""m, the grid of origins: cameras that stand side by side share their meshes' blobs, and most scenes have
the document's own origin."""

_FAR_AWAY = 100.0
"""Sizes of all surfaces together from which they are seen from afar: then theirs must be the fine numbers."""

_Point = NDArray[np.float64]


def frame_of(workspace: Workspace, shapes: Shapes) -> Similarity:
    """Return the last step of every placement: a shift to the sensor if all surfaces are that far out; to the
    surfaces if they are far from both."""
    document = workspace.document
    sensor = np.array(document.sensor.position)
    there, here = np.inf, np.inf
    all_low, all_high = np.full(3, np.inf), np.full(3, -np.inf)
    for low, high in _extents(workspace, shapes):
        there = min(there, _distance(sensor, low, high))
        here = min(here, _distance(np.zeros(3), low, high))
        all_low, all_high = np.minimum(all_low, low), np.maximum(all_high, high)
    if not np.isfinite(here):
        return IDENTITY
    # How large instances are, and what holds media, is not known here.
    only_surfaces = not (document.instances or document.media or document.atmosphere)
    far_away = max(_FAR_AWAY * float(np.max(all_high - all_low)), _STEP)
    if only_surfaces and min(here, there) > far_away:
        return _shift(0.5 * (all_low + all_high), 1.0)
    far_out = here > 0.5 * float(np.linalg.norm(sensor))
    return _shift(sensor, _STEP) if far_out and there < 0.5 * here else IDENTITY


def _shift(to: _Point, step: float) -> Similarity:
    origin = step * np.round(to / step)
    return Similarity(1.0, np.eye(3), -origin) if np.any(origin) else IDENTITY


def _extents(workspace: Workspace, shapes: Shapes) -> Iterator[tuple[_Point, _Point]]:
    """Opposite corners of boxes: of each surface, and of the place of each instance, or of all in a file."""
    for surface in workspace.document.surfaces:
        placement = placement_of(surface)
        match surface.shape:
            case Sphere() as sphere:
                centre, radius = placement.points(np.array(sphere.centre)), sphere.radius * placement.scale
                yield centre - radius, centre + radius
            case MediumBox():
                pass
            case shape:
                try:
                    extent = shapes.extent(shape, placement)
                except (Unusable, UnusableMeshError):
                    continue  # Told where the surface is compiled.
                if extent is not None:  # Told there, too.
                    yield extent
    for instance in workspace.document.instances:
        places = np.zeros((1, 3))
        if instance.placements is not None:
            try:
                places = workspace.placements(instance.placements.asset).shifts
            except (Unusable, UnusableMeshError):
                continue  # Told where the instance is compiled.
        places = placement_of(instance).points(places)
        yield places.min(axis=0), places.max(axis=0)


def _distance(point: _Point, low: _Point, high: _Point) -> float:
    return float(np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0)))
