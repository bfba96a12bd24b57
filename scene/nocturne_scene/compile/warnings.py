"""What a scene says that can hardly be meant: told when it is compiled, and no error."""

import json
import math
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile import spectra
from nocturne_scene.compile.bodies import Body, cross, open_edges, parts, winding, within
from nocturne_scene.compile.coarse import coarse
from nocturne_scene.compile.fine_textures import fine_textures
from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.table_ends import table_ends
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.kernels import Dielectric, Kernel, Lambertian
from nocturne_scene.document.model import SceneDocument, all_surfaces
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import DIGEST_PREFIX, AssetMesh, Disc, InlineMesh, MediumBox, Quad, Sphere
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.document.textures import ColourTexture
from nocturne_scene.film import Film
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.triangles import area_vectors

_MAX_TRIANGLES = 300_000
"""Of a body that is looked at: a second's work. More come from scanners, which close them."""

_MAX_CROSSING = 5_000
"""Triangles of a body that may cross another; points of each are compared with all of the other's."""

_MAX_PAIRS = 100
"""Of bodies that may cross each other."""

_MISSING = 1e-3
"""Part of the light that a limit of interactions may take without being told."""

_MAX_ALIKE = 3
"""Warnings of a kind that are each told: an imported room had 773."""

_PLACES_AND_NUMBERS = re.compile(r"\$[^\s:,]*|\d[\d.e+-]*")

_Corners = NDArray[np.float64]


def warnings_of(workspace: Workspace, shapes: Shapes, film: Film | None) -> list[str]:
    """Sentences with their places; `film`: where it is known."""
    document = workspace.document
    return [
        *_mixture(document),
        *_counted(table_ends(workspace)),
        *_counted(_open_bodies(workspace, shapes)),
        *_counted(_crossing_bodies(document, shapes)),
        *_depth_limit(workspace, shapes),
        *_counted(coarse(workspace, shapes)),
        *_counted(fine_textures(workspace, shapes, film) if film is not None else ()),
    ]


def _counted(sentences: Iterable[str]) -> Iterator[str]:
    """The same; of many that differ in places and numbers alone, the first one and how many others."""
    kinds: dict[str, list[str]] = defaultdict(list)
    for sentence in sentences:
        kinds[_PLACES_AND_NUMBERS.sub("", sentence)].append(sentence)
    for alike in kinds.values():
        if len(alike) > _MAX_ALIKE:
            yield f"{alike[0]}; the same is true of {len(alike) - 1} others, numbers apart"
        else:
            yield from alike


def _mixture(document: SceneDocument) -> Iterator[str]:
    mixture = document.tracing.mixture
    if mixture is not None and mixture.kernel == 0 and mixture.uniform == 0:
        yield (
            "$.tracing.mixture: neither kernel nor uniform has a weight, so light that other surfaces "
            "scatter is lost and the image is too dark"
        )


# --- open bodies ---


def _open_bodies(workspace: Workspace, shapes: Shapes) -> Iterator[str]:
    """Surfaces of one body may close it together: those with the same kernel and interior."""
    document = workspace.document
    bodies: dict[tuple[str, str], list[tuple[str, Surface]]] = defaultdict(list)
    for place, surface in all_surfaces(document):
        if _encloses(document, surface):
            group = place.rpartition("[")[0]
            bodies[(group, f"{surface.kernel!r} {surface.interior!r}")].append((place, surface))
    for boundary in bodies.values():
        edges = _edges_of(workspace, shapes, [surface for _, surface in boundary])
        if edges:
            others = f", together with {len(boundary) - 1} other surfaces" if len(boundary) > 1 else ""
            yield (
                f"{boundary[0][0]}.shape: bounds a body{others}, and is open: {edges} edges belong to one "
                "face only; light that passes there is taken to be inside"
            )


def _edges_of(workspace: Workspace, shapes: Shapes, boundary: list[Surface]) -> int:
    """Open edges; found once for all scenes of a blob store."""
    placed = [
        [repr(surface.shape), placement_of(surface).rows().tolist(), surface.scale] for surface in boundary
    ]
    files = [surface.shape for surface in boundary if isinstance(surface.shape, AssetMesh)]
    about = None
    if files:
        about = NoteKey(files[0].asset.removeprefix(DIGEST_PREFIX), json.dumps(["open edges", placed]))
        match workspace.found_before(about):
            case int(found):
                return found
    try:
        corners = [_corners(shapes, surface) for surface in boundary]
    except (Unusable, UnusableMeshError):
        # Told as an error of the scene.
        return 0
    if sum(map(len, corners)) > _MAX_TRIANGLES:
        return 0
    edges = open_edges(np.concatenate(corners))
    if about is not None:
        workspace.note_found(about, edges)
    return edges


def _encloses(document: SceneDocument, surface: Surface) -> bool:
    """Whether it is part of a body's boundary and not closed by its kind."""
    if not isinstance(surface.shape, Quad | Disc | InlineMesh | AssetMesh):
        return False
    kernel = _kernel(document, surface)
    return (isinstance(kernel, Dielectric) and kernel.outside is None) or surface.interior is not None


def _kernel(document: SceneDocument, surface: Surface) -> Kernel | None:
    return document.kernels[surface.kernel] if isinstance(surface.kernel, str) else surface.kernel


def _corners(shapes: Shapes, surface: Surface) -> _Corners:
    """Of the surface's triangles where they stand, shape (n, 3, 3)."""
    mesh = shapes.triangles(surface.shape)
    return placement_of(surface).points(mesh.vertices[mesh.indices])


# --- bodies that cross each other ---


def _crossing_bodies(document: SceneDocument, shapes: Shapes) -> Iterator[str]:
    """Of two bodies of different glass one needs the higher priority where both are."""
    bodies = []
    for index, surface in enumerate(document.surfaces):
        kernel = _kernel(document, surface)
        if isinstance(kernel, Dielectric) and kernel.outside is None and surface.motion is None:
            bodies.append((path(("surfaces", index)), kernel, surface))
    pairs = [
        (one, other)
        for one, other in combinations(bodies, 2)
        if one[1].priority == other[1].priority and one[1] != other[1]
    ]
    known: dict[str, Body | None] = {}
    for (place, _, surface), (other_place, _, other) in pairs[:_MAX_PAIRS]:
        for each, of in ((place, surface), (other_place, other)):
            if each not in known:
                known[each] = _body(shapes, of)
        one_body, other_body = known[place], known[other_place]
        if one_body is None or other_body is None:
            continue
        if cross(one_body, other_body):
            yield (
                f"{other_place}.shape: crosses the body of {place}, and both have the same priority; say by "
                "their kernels' priorities which of them is there"
            )
        for inner, outer, is_inner in (
            (place, other_place, within(one_body, other_body)),
            (other_place, place, within(other_body, one_body)),
        ):
            if is_inner:
                yield (
                    f"{inner}.shape: is inside of the body of {outer}, which has the same priority and is "
                    "there instead; give the kernel of the inner one a higher priority"
                )


def _body(shapes: Shapes, surface: Surface) -> Body | None:
    """None where it is none by itself, or too large to be looked at."""
    placement = placement_of(surface)
    if isinstance(surface.shape, Sphere):
        centre = placement.points(np.array(surface.shape.centre))
        return Body(np.empty((0, 3, 3)), centre, surface.shape.radius * placement.scale)
    if isinstance(surface.shape, MediumBox | Quad | Disc):
        return None
    try:
        corners = _corners(shapes, surface)
    except (Unusable, UnusableMeshError):
        return None
    if not 0 < len(corners) <= _MAX_CROSSING or open_edges(corners):
        return None
    return Body.of(corners)


# --- rooms at the limit of interactions ---


def _depth_limit(workspace: Workspace, shapes: Shapes) -> Iterator[str]:
    depth = workspace.document.tracing.maximum_depth
    albedo = None if depth is None else _albedo_around(workspace, shapes)
    if depth is None or albedo is None:
        return
    missing = albedo ** (depth + 1)
    if missing > _MISSING:
        yield (
            f"$.tracing.maximum_depth: the sensor is in a closed room that reflects up to {albedo:.1%} of "
            f"the light, so up to {missing:.2g} of it comes after more than {depth} interactions and is "
            "missing; without a limit nothing is"
        )


def _albedo_around(workspace: Workspace, shapes: Shapes) -> float | None:
    """What diffuse walls that enclose the sensor reflect at most, on the mean over their area; None: nothing
    encloses it, or that is not known."""
    document = workspace.document
    sensor = np.array(document.sensor.position)
    all_corners, all_albedos = [], []
    for surface in document.surfaces:
        albedo = _albedo(workspace, _kernel(document, surface))
        if albedo is None or isinstance(surface.shape, MediumBox):
            continue
        if isinstance(surface.shape, Sphere):
            placement = placement_of(surface)
            away = np.linalg.norm(sensor - placement.points(np.array(surface.shape.centre)))
            if away < surface.shape.radius * placement.scale:
                return albedo
            continue
        try:
            corners = _corners(shapes, surface)
        except (Unusable, UnusableMeshError):
            return None
        all_corners.append(corners)
        all_albedos.append(np.full(len(corners), albedo))
    if not all_corners or sum(map(len, all_corners)) > _MAX_TRIANGLES:
        return None
    corners, albedos = np.concatenate(all_corners), np.concatenate(all_albedos)
    part_of = parts(corners)
    for part in np.unique(part_of):
        walls = corners[part_of == part]
        if open_edges(walls) == 0 and abs(float(winding(walls, sensor[None])[0])) > 0.5:
            areas = np.linalg.norm(area_vectors(walls), axis=-1)
            return float(np.average(albedos[part_of == part], weights=areas))
    return None


def _albedo(workspace: Workspace, kernel: Kernel | None) -> float | None:
    """Of a diffuse surface at its brightest wavelength; None: it is another one."""
    if not isinstance(kernel, Lambertian):
        return None
    value = kernel.reflectance
    reference = value.spectrum if isinstance(value, ColourTexture) else value
    try:
        found = max(spectra.reflectance(workspace.spectrum(reference), workspace.spectral).values)
    except spectra.NotCompilableError:
        return None
    return None if math.isnan(found) else float(found)
