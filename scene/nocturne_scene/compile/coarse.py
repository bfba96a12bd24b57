"""Parts that are too coarse, or too far apart, for the numbers and approximations that images are made by."""

import json
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile.placement import placement_of, placements_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.kernels import Conductor, Kernel, Lambertian
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import DIGEST_PREFIX, AssetMesh, InlineMesh, MediumBox, Sphere
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.triangles import area_vectors, unit_normals
from nocturne_scene.textures import environment_maps, pictures

_ROUNDING = 2.0**-24
"""Part of a coordinate that a float may be off by."""

_DIGITS = 100.0
"""Roundings that are the least size of what moves: with fewer its shape is off by a percent."""

_TOUCHING = 8.0
"""Roundings within which two places are one."""

_BENT = 0.03
"""One minus the cosine of 14 degrees, between a mesh's faces and its normals; with 0.06 a white ball of 80
triangles in even light is 1 % too dark."""

_POLE = 1e-3
"""Part of the light on a surface that faces a pole of a map."""

_FEW = 64
"""Vertices of surfaces that are compared with each other."""


def coarse(workspace: Workspace, shapes: Shapes) -> Iterator[str]:
    """Sentences with their places."""
    placed: dict[bytes, str] = {}
    for index, surface in enumerate(workspace.document.surfaces):
        place = path(("surfaces", index))
        try:
            yield from _far_moved(workspace, shapes, surface, place)
            yield from _touched_by_sensor(workspace, surface, place)
            yield from _doubled(workspace, shapes, surface, place, placed)
            yield from _bent(workspace, shapes, surface, place)
        except (Unusable, UnusableMeshError):
            continue  # Told as an error of the scene.
    yield from _poles(workspace)


def _far_moved(workspace: Workspace, shapes: Shapes, surface: Surface, place: str) -> Iterator[str]:
    shape = surface.shape
    if surface.motion is None or isinstance(shape, MediumBox):
        return
    corners = (
        np.array(shape.centre) + shape.radius * np.array([[-1.0] * 3, [1.0] * 3])
        if isinstance(shape, Sphere)
        else shapes.vertices(shape)
    )
    size = surface.scale * float(np.ptp(corners, axis=0).max())
    steps = [workspace.frame.after(step) for step in placements_of(surface)]
    far = max(float(np.abs(step.points(corners)).max()) for step in steps)
    if size < _DIGITS * _ROUNDING * far:
        yield (
            f"{place}.motion: moves {size:.3g} m of surface {far:.3g} m away, where single precision tells "
            f"{2 * _ROUNDING * far:.2g} m apart; keep still what does not move against the sensor"
        )


def _touched_by_sensor(workspace: Workspace, surface: Surface, place: str) -> Iterator[str]:
    """A sphere that the sensor lies on: each ray starts inside or outside by the rounding of its numbers."""
    if not isinstance(surface.shape, Sphere) or surface.motion is not None:
        return
    placement = placement_of(surface)
    position, centre = (
        np.array(workspace.document.sensor.position),
        placement.points(np.array(surface.shape.centre)),
    )
    radius = surface.shape.radius * placement.scale
    largest = max(float(np.abs([position, centre]).max()), radius)
    if abs(float(np.linalg.norm(position - centre)) - radius) < _TOUCHING * _ROUNDING * largest:
        yield (
            f"$.sensor.position: lies on the sphere of {place}, so that rays start inside or outside of it "
            f"by rounding, and light is wrong by percents; move it by {1e-4 * radius:.1g} m"
        )


def _doubled(
    workspace: Workspace, shapes: Shapes, surface: Surface, place: str, placed: dict[bytes, str]
) -> Iterator[str]:
    """Opaque surfaces with the same corners: only one of them is met, from either side."""
    shape = surface.shape
    if isinstance(shape, Sphere | AssetMesh | MediumBox) or surface.interior or surface.motion:
        return
    if not isinstance(_kernel(workspace, surface), Lambertian | Conductor):
        return
    vertices = shapes.vertices(shape)
    if len(vertices) > _FEW:
        return
    corners = np.unique((placement_of(surface).points(vertices) + 0.0).astype(np.float32), axis=0)
    other = placed.setdefault(corners.tobytes(), place)
    if other != place:
        yield (
            f"{place}: lies exactly on {other}, so light meets only one of them, from either side; "
            "leave a gap, or make them one surface, with two_sided where it emits"
        )


def _bent(workspace: Workspace, shapes: Shapes, surface: Surface, place: str) -> Iterator[str]:
    shape = surface.shape
    if not isinstance(shape, InlineMesh | AssetMesh) or not shape.smooth:
        return
    about = None
    if isinstance(shape, AssetMesh):
        text = json.dumps(["bent normals", shape.resolved_format()])
        about = NoteKey(shape.asset.removeprefix(DIGEST_PREFIX), text)
    bent = workspace.found_before(about) if about else None
    if not isinstance(bent, float):
        mesh = shapes.triangles(shape)
        bent = _bend(mesh.vertices[mesh.indices], unit_normals(mesh)[mesh.indices])
        if about:
            workspace.note_found(about, bent)
    if bent > _BENT:
        degrees = np.degrees(np.arccos(1.0 - bent))
        yield (
            f"{place}.shape: its interpolated normals are {degrees:.0f} degrees off its triangles, which "
            "loses or adds percents of light; use a finer mesh, or flat triangles"
        )


def _bend(corners: NDArray[np.float64], normals: NDArray[np.float64]) -> float:
    """One minus the cosine between triangles and their corners' normals, on the mean over the area."""
    across = area_vectors(corners)
    total = float(np.linalg.norm(across, axis=-1).sum())
    along = float(np.abs(np.einsum("ti,tci->tc", across, normals)).mean(axis=1).sum())
    return 1.0 - along / total if total > 0.0 else 0.0


def _kernel(workspace: Workspace, surface: Surface) -> Kernel | None:
    kernels = workspace.document.kernels
    return kernels[surface.kernel] if isinstance(surface.kernel, str) else surface.kernel


def _poles(workspace: Workspace) -> Iterator[str]:
    environment = workspace.document.environment
    if not isinstance(environment, EnvironmentMap) or environment.pixels == "points":
        return
    try:
        asset = workspace.asset(environment.asset).hex()
        about = NoteKey(asset, json.dumps(["poles"]))
        change = workspace.found_before(about)
        if not isinstance(change, float):
            change = environment_maps.polar_change(workspace.blobs.path(asset))
            workspace.note_found(about, change)
    except (Unusable, pictures.UnusableImageError):
        return  # Told as an error of the scene.
    if change > _POLE:
        yield (
            "$.environment.asset: what is bright at a pole of the map is spread over its texels and lights "
            f"what faces it by {change:.2%} more or less; use a map with more rows, or a disc in $.distant"
        )
