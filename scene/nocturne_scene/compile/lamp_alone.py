"""An intensity meter is made for a lamp by itself. A body or light outside of its sphere counts where
photons from the meter see it through the sphere; those from luminaires bring all of it that leaves the scene.
"""

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.problems import path
from nocturne_scene.document.sensors import IntensityMeter
from nocturne_scene.document.shapes import MediumBox, Sphere
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.meshes.headers import UnusableMeshError

_ROUNDING = 1e-5
"""Part of the radius."""


def check_lamp_alone(workspace: Workspace, shapes: Shapes, message: scene_pb2.CompiledScene) -> None:
    """Warns of each thing outside; then photons start at luminaires only where the document says so.

    Surfaces that move are looked at where they stand at first, and those of groups are not.
    """
    document = workspace.document
    sensor = document.sensor
    if not isinstance(sensor, IntensityMeter):
        return
    outside = []
    if message.HasField("environment"):
        outside.append("$.environment: shines from outside")
    if message.distant_discs:
        outside.append("$.distant: shines from outside")
    if message.unbounded_interiors:
        outside.append("$.unbounded_media: lie outside")
    centre = np.array(sensor.position)
    for index, surface in enumerate(document.surfaces):
        farthest = _farthest(shapes, surface, centre)
        if farthest > sensor.lamp_radius * (1.0 + _ROUNDING):
            place = path(("surfaces", index))
            outside.append(f"{place}.shape: reaches {farthest:.6g} m from the meter's position, outside")
    if not outside:
        return
    counts = (
        "it leaves the scene" if document.tracing.direction == "forward" else "it is seen through the sphere"
    )
    workspace.warnings.extend(
        f"{what} of the intensity meter's sphere of {sensor.lamp_radius:g} m; it counts where {counts}"
        for what in outside
    )
    workspace.photons_can_start = False


def _farthest(
    shapes: Shapes, surface: Surface, centre: "np.ndarray[tuple[int], np.dtype[np.float64]]"
) -> float:
    """Of the surface's points from there, m; 0 where that is not known."""
    if isinstance(surface.shape, MediumBox):
        return 0.0
    placement = placement_of(surface)
    if isinstance(surface.shape, Sphere):
        middle = placement.points(np.array(surface.shape.centre))
        return float(np.linalg.norm(middle - centre)) + surface.shape.radius * placement.scale
    try:
        placed = placement.points(shapes.vertices(surface.shape))
    except (Unusable, UnusableMeshError):
        return 0.0
    return float(np.linalg.norm(placed - centre, axis=1).max()) if len(placed) else 0.0
