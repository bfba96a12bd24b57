"""What a scene says that can hardly be meant: told when it is compiled, and no error."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.kernels import Dielectric
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import AssetMesh, Disc, InlineMesh, Quad
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.meshes.headers import UnusableMeshError

_WELDED = 1e-6
"""Of a body's size: corners closer than this are one."""

_MAX_TRIANGLES = 300_000
"""Of a body that is looked at: a second's work. More come from scanners, which close them."""

_Corners = NDArray[np.float64]


def warnings_of(workspace: Workspace, shapes: Shapes, film: tuple[int, int] | None) -> list[str]:
    """Sentences with their places; `film`: width and height in pixels, where they are known."""
    document = workspace.document
    return [*_mixture(document), *_open_bodies(document, shapes)]


def _mixture(document: SceneDocument) -> Iterator[str]:
    mixture = document.tracing.mixture
    if mixture is not None and mixture.kernel == 0 and mixture.uniform == 0:
        yield (
            "$.tracing.mixture: neither kernel nor uniform has a weight, so light that other surfaces "
            "scatter is lost and the image is too dark"
        )


def _open_bodies(document: SceneDocument, shapes: Shapes) -> Iterator[str]:
    """Surfaces of one body may close it together: those with the same kernel and interior."""
    bodies: dict[tuple[str, str], list[tuple[str, Surface]]] = defaultdict(list)
    for group, place, surface in _surfaces(document):
        if _encloses(document, surface):
            bodies[(group, f"{surface.kernel!r} {surface.interior!r}")].append((place, surface))
    for parts in bodies.values():
        try:
            corners = [_corners(shapes, surface) for _, surface in parts]
        except (Unusable, UnusableMeshError):
            # Told as an error of the scene.
            continue
        if sum(map(len, corners)) > _MAX_TRIANGLES:
            continue
        if edges := _open_edges(np.concatenate(corners)):
            others = f", together with {len(parts) - 1} other surfaces" if len(parts) > 1 else ""
            yield (
                f"{parts[0][0]}.shape: bounds a body{others}, and is open: {edges} edges belong to one face "
                "only; light that passes there is taken to be inside"
            )


def _surfaces(document: SceneDocument) -> Iterator[tuple[str, str, Surface]]:
    for index, surface in enumerate(document.surfaces):
        yield "", path(("surfaces", index)), surface
    for name, group in document.groups.items():
        for index, part in enumerate(group):
            if isinstance(part, Surface):
                yield name, path(("groups", name, index)), part


def _encloses(document: SceneDocument, surface: Surface) -> bool:
    """Whether it is part of a body's boundary and not closed by its kind."""
    if not isinstance(surface.shape, Quad | Disc | InlineMesh | AssetMesh):
        return False
    kernel = document.kernels[surface.kernel] if isinstance(surface.kernel, str) else surface.kernel
    return isinstance(kernel, Dielectric) or surface.interior is not None


def _corners(shapes: Shapes, surface: Surface) -> _Corners:
    """Of the surface's triangles where they stand, shape (n, 3, 3)."""
    mesh = shapes.triangles(surface.shape)
    return placement_of(surface).points(mesh.vertices[mesh.indices])


def _open_edges(corners: _Corners) -> int:
    """Edges that an odd number of triangles have."""
    points = corners.reshape(-1, 3)
    points = points - points.min(axis=0)
    # Up to 10^6 each, so that three of them are one whole number.
    places = np.rint(points / (_WELDED * float(points.max()))).astype(np.int64)
    _, names = np.unique(places @ np.array([1 << 42, 1 << 21, 1]), return_inverse=True)
    triangles = names.reshape(-1, 3)
    ends = np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    ends = ends[ends[:, 0] != ends[:, 1]]
    _, counts = np.unique(ends @ np.array([names.max() + 1, 1]), return_counts=True)
    return int(np.count_nonzero(counts % 2))
