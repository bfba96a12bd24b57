"""Shapes where they stand, as messages and blobs."""

import json
import math
from collections.abc import Sequence

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile.grids import Grids
from nocturne_scene.compile.sensors import vector
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import (
    DIGEST_PREFIX,
    AssetMesh,
    Box,
    Disc,
    InlineMesh,
    MediumBox,
    Quad,
    Shape,
    Sphere,
)
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.similarity import Similarity
from nocturne_scene.meshes.simple import simple_mesh
from nocturne_scene.meshes.triangles import (
    BadVertexError,
    PackedMesh,
    Triangles,
    area_vectors,
    pack_mesh,
    unit_normals,
)

_CONVERSION = 1
"""Number of how mesh files become blobs; raised with every change of that, since blobs are kept."""

AnyShape = scene_pb2.Quad | scene_pb2.Sphere | scene_pb2.Mesh


class Shapes:
    """Compiles shapes; each mesh file is read once, and not at all where an earlier scene had it alike."""

    def __init__(self, workspace: Workspace, grids: Grids) -> None:
        self._workspace = workspace
        self._grids = grids
        self._loaded: dict[tuple[str, str, bool], Triangles] = {}

    def compile(
        self, shape: Shape, steps: Sequence[Similarity], place: str, *, coordinates: bool = False
    ) -> AnyShape:
        """Return a shape at its placements; `coordinates`: its texture coordinates are needed.

        `place` is for the report of triangles that are left out. Raises Unusable and UnusableMeshError.
        """
        match shape:
            case Quad() if len(steps) == 1:
                return _quad(shape, steps[0])
            case Sphere():
                return _sphere(shape, steps)
            case AssetMesh():
                try:
                    return self._asset_mesh(shape, steps, place, coordinates)
                except (UnusableMeshError, Unusable) as error:
                    raise Unusable(str(error), ".asset") from None
            case MediumBox():
                return self._medium_box(shape, place)
            case InlineMesh():
                try:
                    mesh = simple_mesh(shape)
                    return self._new_mesh(mesh, shape.smooth, steps, place, coordinates)
                except BadVertexError as error:
                    raise Unusable(error.reason, f".vertices[{error.index}]") from None
        return self._new_mesh(simple_mesh(shape), False, steps, place, coordinates=True)

    def extent(
        self, shape: AssetMesh | InlineMesh | Quad | Disc | Box, placement: Similarity
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Return opposite corners of a box around a placed shape; None if it has no vertices. Unusable,
        UnusableMeshError."""
        about = None
        if isinstance(shape, AssetMesh):
            self._workspace.asset(shape.asset)
            about = _about("extent", shape, [placement])
            match self._workspace.found_before(about):
                case [[float(), float(), float()] as low, [float(), float(), float()] as high]:
                    return np.array(low), np.array(high)
        placed = placement.points(self.vertices(shape))
        if not len(placed):
            return None
        corners = placed.min(axis=0), placed.max(axis=0)
        if about and np.isfinite(corners).all():
            self._workspace.note_found(about, [corner.tolist() for corner in corners])
        return corners

    def vertices(self, shape: AssetMesh | InlineMesh | Quad | Disc | Box) -> NDArray[np.float64]:
        """Return a shape's corners before its placement, shape (n, 3). Unusable, UnusableMeshError."""
        return self.triangles(shape).vertices

    def triangles(self, shape: Shape) -> Triangles:
        """A shape that consists of triangles, before its placement. Raises Unusable, UnusableMeshError."""
        match shape:
            case Sphere() | MediumBox():
                raise Unusable("is no shape of triangles", ".shape")
            case AssetMesh():
                return self._asset(shape)
        return simple_mesh(shape)

    def area(self, shape: Shape) -> float:
        """Area of a shape before its placement, m2. Raises Unusable, UnusableMeshError."""
        if isinstance(shape, Sphere):
            return 4 * math.pi * shape.radius**2
        mesh = self.triangles(shape)
        return _area(mesh.vertices[mesh.indices])

    def area_of_texture(self, shape: Shape) -> float:
        """Square metres that a whole texture covers on the mean over a shape before its placement; 0: it has
        no coordinates. Raises Unusable, UnusableMeshError."""
        about = None
        if isinstance(shape, AssetMesh):
            about = _about("area of texture", shape, [])
            match self._workspace.found_before(about):
                case float(found):
                    return found
        mesh, area = self.triangles(shape), 0.0
        if mesh.coordinates is not None:
            flat = np.pad(mesh.coordinates, ((0, 0), (0, 1)))[mesh.indices]
            covered = _area(flat)
            area = _area(mesh.vertices[mesh.indices]) / covered if covered > 0.0 else 0.0
        if about and math.isfinite(area):
            self._workspace.note_found(about, area)
        return area

    def is_flat(self, shape: Shape) -> bool:
        """Whether a shape lies in a plane, within a ten-thousandth of its size."""
        match shape:
            case Quad() | Disc():
                return True
            case Box() | Sphere() | MediumBox():
                return False
        vertices = self.vertices(shape)
        centred = vertices - vertices.mean(axis=0)
        _, sizes, _ = np.linalg.svd(centred.T @ centred)
        return bool(sizes[2] <= 1e-8 * sizes[0])

    def _medium_box(self, shape: MediumBox, place: str) -> scene_pb2.Mesh:
        grid = self._workspace.document.media[shape.medium].grid_density()
        if grid is None:
            raise Unusable("the medium has no grid", ".medium")
        try:
            box = self._grids.box(grid)
        except Unusable as error:
            medium = path(("media", shape.medium))
            raise Unusable(f"{medium}.density{error.suffix}: {error}", ".medium") from None
        return self._new_mesh(box, False, [self._workspace.frame], place, coordinates=False)

    def _asset_mesh(
        self, shape: AssetMesh, steps: Sequence[Similarity], place: str, coordinates: bool
    ) -> scene_pb2.Mesh:
        """The same, made once for all scenes of a blob store."""
        self._workspace.asset(shape.asset)
        about = _about(f"mesh, coordinates {coordinates}", shape, steps)
        match self._workspace.made_before(about):
            case (bytes(blob), [int(vertices), int(triangles), int(dropped)]):
                packed = PackedMesh(b"", vertices, triangles, dropped)
            case _:
                packed = _packed(self._asset(shape), shape.smooth, steps, coordinates)
                blob = self._workspace.keep(packed.blob)
                counts = [packed.vertex_count, packed.triangle_count, packed.dropped_triangles]
                self._workspace.note_made(about, blob, counts)
        return self._mesh(packed, blob, place, shape.smooth, coordinates, len(steps))

    def _asset(self, shape: AssetMesh) -> Triangles:
        key = (shape.asset, shape.resolved_format(), shape.smooth)
        if key not in self._loaded:
            # Late: trimesh, which reads the files, takes a third of a second to import.
            from nocturne_scene.meshes.files import load_mesh

            file = self._workspace.blobs.path(self._workspace.asset(shape.asset).hex())
            self._loaded[key] = load_mesh(file, shape.resolved_format(), normals=shape.smooth)
        return self._loaded[key]

    def _new_mesh(
        self, mesh: Triangles, smooth: bool, steps: Sequence[Similarity], place: str, coordinates: bool
    ) -> scene_pb2.Mesh:
        packed = _packed(mesh, smooth, steps, coordinates)
        blob = self._workspace.keep(packed.blob)
        return self._mesh(packed, blob, place, smooth, coordinates, len(steps))

    def _mesh(
        self, packed: PackedMesh, blob: bytes, place: str, smooth: bool, coordinates: bool, steps: int
    ) -> scene_pb2.Mesh:
        if packed.dropped_triangles:
            self._workspace.dropped.append(f"{place}: {packed.dropped_triangles} triangles without an area")
        return scene_pb2.Mesh(
            blob=blob,
            vertex_count=packed.vertex_count,
            triangle_count=packed.triangle_count,
            normals=smooth,
            texture_coordinates=coordinates,
            time_steps=steps if steps > 1 else 0,
        )


def _packed(mesh: Triangles, smooth: bool, steps: Sequence[Similarity], coordinates: bool) -> PackedMesh:
    if coordinates and mesh.coordinates is None:
        raise UnusableMeshError(
            "the surface has a texture, or a roughness with two directions, and the mesh has no texture "
            "coordinates"
        )
    wanted = Triangles(
        mesh.vertices,
        mesh.indices,
        unit_normals(mesh) if smooth else None,
        mesh.coordinates if coordinates else None,
    )
    return pack_mesh(wanted, steps)


def _area(corners: NDArray[np.float64]) -> float:
    """Of triangles, shape (n, 3, 3)."""
    return float(np.linalg.norm(area_vectors(corners), axis=-1).sum()) / 2


def _about(what: str, shape: AssetMesh, steps: Sequence[Similarity]) -> NoteKey:
    """What a note says of a mesh file at its placements."""
    placed = [step.rows().tolist() for step in steps]
    text = json.dumps([what, shape.resolved_format(), shape.smooth, placed, _CONVERSION])
    return NoteKey(shape.asset.removeprefix(DIGEST_PREFIX), text)


def put_shape(message: scene_pb2.Surface | scene_pb2.ImportantShape, shape: AnyShape) -> None:
    """Set the shape of a surface or of an important shape."""
    match shape:
        case scene_pb2.Quad():
            message.quad.CopyFrom(shape)
        case scene_pb2.Sphere():
            message.sphere.CopyFrom(shape)
        case _:
            message.mesh.CopyFrom(shape)


def _quad(quad: Quad, placement: Similarity) -> scene_pb2.Quad:
    edge_u, edge_v = placement.directions(np.array(quad.edge_u)), placement.directions(np.array(quad.edge_v))
    _check_length(".edge_u", float(np.linalg.norm(edge_u)))
    _check_length(".edge_v", float(np.linalg.norm(edge_v)))
    corner = placement.points(np.array(quad.corner))
    _check_distance(".corner", corner)
    return scene_pb2.Quad(corner=vector(corner), edge_u=vector(edge_u), edge_v=vector(edge_v))


def _sphere(sphere: Sphere, steps: Sequence[Similarity]) -> scene_pb2.Sphere:
    if any(abs(step.scale - steps[0].scale) > 1e-12 * steps[0].scale for step in steps):
        raise Unusable("a sphere can't change its scale while it moves; use a mesh")
    centres = [step.points(np.array(sphere.centre)) for step in steps]
    radius = sphere.radius * steps[0].scale
    for centre in centres:
        _check_distance(".centre", centre)
    _check_length(".radius", radius)
    return scene_pb2.Sphere(
        centre=vector(centres[0]), radius=radius, later_centres=[vector(centre) for centre in centres[1:]]
    )


def _check_length(suffix: str, length: float) -> None:
    if not bounds.MIN_SIZE <= length <= bounds.LENGTH:
        raise Unusable(
            f"is {length:g} m long once scaled; expected {bounds.MIN_SIZE:g} to {bounds.LENGTH:g} m",
            suffix,
        )


def _check_distance(suffix: str, point: NDArray[np.float64]) -> None:
    if not np.all(np.abs(point) <= bounds.LENGTH):
        raise Unusable(f"is farther than {bounds.LENGTH:g} m from the origin once placed", suffix)
