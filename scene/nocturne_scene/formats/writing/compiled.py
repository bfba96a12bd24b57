"""A compiled scene as exporters read it: tables, triangles, pictures, and the contents of bodies.

Exporters read the compiled scene and not the document, so that both renderers get the same tables, matrices
and triangles.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.unseen import met_surfaces
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.writing.tables import Array, Table, table_of
from nocturne_scene.meshes.triangles import Triangles
from nocturne_scene.scene_ranges import range_of
from nocturne_scene.spectra.wavelength_range import VISIBLE
from nocturne_scene.textures import texture_files

# No edge of a scene made by people has this direction.
_ASKEW = np.array([0.4802871, 0.6120413, 0.6282357])


@dataclass(frozen=True)
class Medium:
    """What light meets: coefficients (with a grid, at density 1), and how it scatters."""

    absorption: Table
    scattering: Table
    phase: scene_pb2.PhaseFunction
    density: scene_pb2.DensityGrid | None = None
    """None: the density is 1 everywhere."""


@dataclass(frozen=True)
class Body:
    """What a closed surface encloses."""

    index: Table | None
    """None: that of the surroundings."""
    media: tuple[Medium, ...]
    outside: Table | None = None
    """The index on the other side, where the surface bounds no body."""

    @property
    def is_empty(self) -> bool:
        """Whether no light is lost inside."""
        return not self.media


@dataclass(frozen=True)
class Placed:
    """A surface where it is in the scene."""

    surface: scene_pb2.Surface
    place: str
    """Where it is described."""
    placement: Array
    """The 3 x 4 matrix that it is placed by."""


class Compiled:
    """A compiled scene with its blobs, and the document that it is of.

    Lengths of its message are metres; those of what the methods give are in the unit of the export.
    """

    def __init__(
        self,
        message: scene_pb2.CompiledScene,
        blobs: BlobStore,
        document: SceneDocument,
        findings: Findings,
    ) -> None:
        self.message = message
        self.blobs = blobs
        self.document = document
        self.findings = findings
        self._met = met_surfaces(document)
        self.metre = 1.0
        """In the unit of the export."""
        self.renderer = "pbrt"
        """For messages; as `metre`, the exporter's to set."""

    def place(self, surface: int) -> str:
        """Where a surface is described."""
        if surface < len(self._met):
            return f"$.surfaces[{self._met[surface]}]"
        return "$.groups" if self.message.surfaces[surface].group else "$.atmosphere"

    def table(self, index: int) -> Table:
        """A spectrum of the scene."""
        return table_of(self.message.spectra[index])

    def body(self, surface: scene_pb2.Surface, place: str) -> Body | None:
        """What a surface encloses; None for nothing."""
        if not surface.HasField("interior"):
            return None
        return self._body(self.message.interiors[surface.interior], place)

    def everywhere(self) -> Body:
        """What fills all of space."""
        media: tuple[Medium, ...] = ()
        for index in self.message.unbounded_interiors:
            media += self._body(self.message.interiors[index], "$.unbounded_media").media
        return Body(None, media)

    def _body(self, interior: scene_pb2.Interior, place: str) -> Body:
        media = [self._medium(self.message.media[index], place) for index in interior.media]
        if interior.HasField("absorption"):
            isotropic = scene_pb2.PhaseFunction(henyey_greenstein=scene_pb2.HenyeyGreenstein(g=0.0))
            media.append(Medium(self._coefficient(interior.absorption, 1.0), Table(np.zeros(1)), isotropic))
        index = None if interior.index_matched else self.table(interior.index)
        outside = self.table(interior.outside) if interior.HasField("outside") else None
        return Body(index, tuple(media), outside)

    def _medium(self, medium: scene_pb2.Medium, place: str) -> Medium:
        if medium.HasField("temperature"):
            self.findings.lost(place, "a medium that glows can't be exported")
        if medium.fluorophores:
            self.findings.lost(place, "a medium that fluoresces can't be exported")
        grid = medium.grid if medium.WhichOneof("density") == "grid" else None
        if medium.WhichOneof("density") == "altitude":
            self.findings.lost(place, "a density that depends on altitude can't be exported")
        factor = 1.0 if grid else medium.constant
        absorption, scattering = (
            self._coefficient(index, factor) for index in (medium.absorption, medium.scattering)
        )
        return Medium(absorption, scattering, medium.phase, grid)

    def _coefficient(self, index: int, factor: float) -> Table:
        table = self.table(index)
        return Table(factor / self.metre * table.values, table.wavelengths)

    def mesh(self, mesh: scene_pb2.Mesh, place: str) -> Triangles:
        """Triangles of a mesh at rest."""
        if mesh.time_steps > 1:
            self.findings.lost(place, "motion can't be exported")
        blob = self.blobs.path(mesh.blob.hex()).read_bytes()
        floats = iter(np.split(np.frombuffer(blob, "<f4", _floats(mesh)), _ends(mesh)))
        vertices = next(floats).reshape(-1, 3)[: mesh.vertex_count].astype(np.float64)
        normals = next(floats).reshape(-1, 3)[: mesh.vertex_count] if mesh.normals else None
        coordinates = next(floats).reshape(-1, 2) if mesh.texture_coordinates else None
        indices = np.frombuffer(blob, "<u4", 3 * mesh.triangle_count, 4 * _floats(mesh))
        return Triangles(
            self.metre * vertices,
            indices.reshape(-1, 3).astype(np.int64),
            None if normals is None else normals.astype(np.float64),
            None if coordinates is None else coordinates.astype(np.float64),
        )

    def quad(self, quad: scene_pb2.Quad) -> tuple[Array, Array, Array]:
        """Corner and both edges."""
        corner, u, v = (self.point(each) for each in (quad.corner, quad.edge_u, quad.edge_v))
        return corner, u, v

    def sphere(self, sphere: scene_pb2.Sphere, place: str) -> tuple[Array, float]:
        """Centre and radius."""
        if sphere.later_centres:
            self.findings.lost(place, "motion can't be exported")
        return self.point(sphere.centre), self.metre * sphere.radius

    def point(self, vector: scene_pb2.Vector) -> Array:
        """A point, or a difference of two."""
        return self.metre * array(vector)

    def placement(self, instance: scene_pb2.Instance) -> Array:
        """The 3 x 4 matrix of an instance at rest."""
        if len(instance.transforms) != 12:
            self.findings.lost("$.instances", "motion can't be exported")
        rows = np.array(instance.transforms[:12]).reshape(3, 4)
        rows[:, 3] *= self.metre
        return rows

    def size(self) -> float:
        """The largest distance of a coordinate of the scene from 0, or the sensor's."""
        corners = [abs(self.point(self.message.sensor.position))]
        for at, surface in self.standing():
            corners += [abs(corner) for corner in self.bounds(surface, self.place(at))]
        return float(np.max(corners))

    def picture(self, texture: int) -> Array:
        """Linear values of a texture, shape (height, width, 1 or 3), the top row first."""
        content = self.blobs.path(self.message.textures[texture].blob.hex()).read_bytes()
        return texture_files.finest(content).astype(np.float64)

    def triangles(self, surface: scene_pb2.Surface, place: str) -> Triangles | None:
        """A surface's triangles; None for a sphere."""
        match surface.WhichOneof("shape"):
            case "mesh":
                return self.mesh(surface.mesh, place)
            case "quad":
                corner, u, v = self.quad(surface.quad)
                vertices = np.array([corner, corner + u, corner + u + v, corner + v])
                return Triangles(vertices, np.array([[0, 1, 2], [0, 2, 3]]))
        return None

    def bounds(self, surface: scene_pb2.Surface, place: str) -> tuple[Array, Array]:
        """The lowest and highest corner of the box around a surface."""
        mesh = self.triangles(surface, place)
        if mesh is not None:
            return mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        centre, radius = self.sphere(surface.sphere, place)
        return centre - radius, centre + radius

    def encloses(self, surface: scene_pb2.Surface, point: Array, place: str) -> bool:
        """Whether a point is inside of a closed surface."""
        mesh = self.triangles(surface, place)
        if mesh is None:
            centre, radius = self.sphere(surface.sphere, place)
            return bool(np.linalg.norm(point - centre) < radius)
        return _crossings(mesh, point) % 2 == 1

    def around_sensor(self, everywhere: Body) -> tuple[Body | None, str]:
        """What the sensor stands in, and where that is described."""
        position = self.point(self.message.sensor.position)
        for body in self.bodies():
            inside = np.asarray(np.linalg.solve(body.placement[:, :3], position - body.placement[:, 3]))
            if self.encloses(body.surface, inside, body.place):
                return self.body(body.surface, body.place), f"{body.place}.interior"
        return everywhere, "$.unbounded_media"

    def is_textured(self, surface: scene_pb2.Surface) -> bool:
        """Whether a kernel of a surface has a texture."""
        kernels = [surface.kernel] + ([surface.back_kernel] if surface.HasField("back_kernel") else [])
        return any("texture" in str(self.message.kernels[index]) for index in kernels)

    def bodies(self) -> Iterator[Placed]:
        """Surfaces that enclose something, as often as they are in the scene; boundaries between two indices
        do not."""
        in_groups: dict[int, list[int]] = {}
        bodies = [not each.HasField("outside") for each in self.message.interiors]
        for at, surface in enumerate(self.message.surfaces):
            if surface.HasField("interior") and bodies[surface.interior]:
                in_groups.setdefault(surface.group, []).append(at)
        frames = [(0, np.eye(3, 4))]
        frames += [(each.group, self.placement(each)) for each in self.message.instances]
        for group, placement in frames:
            for at in in_groups.get(group, ()):
                yield Placed(self.message.surfaces[at], self.place(at), placement)

    def standing(self) -> Iterator[tuple[int, scene_pb2.Surface]]:
        """Surfaces that are in the scene once, with their index."""
        return ((at, each) for at, each in enumerate(self.message.surfaces) if each.group == 0)

    def scatterer(self, body: Body, place: str) -> Medium:
        """The medium of a body whose phase function other renderers take for all of them."""
        first, *others = body.media
        if any(each.phase != first.phase and not each.scattering.is_black for each in others):
            self.findings.lost(place, "media with different phase functions in one body can't be exported")
        return next((each for each in body.media if not each.scattering.is_black), first)

    def numbers(self, use: scene_pb2.TextureUse, *, complement: bool) -> Array:
        """The picture of a number that varies, or of 1 less that number."""
        values = np.clip(use.gain * self.picture(use.texture) + use.bias, 0.0, 1.0)
        return 1 - values if complement else values

    def colours(self, colour: scene_pb2.Colour, place: str) -> Array:
        """The picture of a colour that varies."""
        table = self.table(colour.spectrum)
        if table.constant is None:
            self.findings.lost(place, f"a texture times a spectrum is not supported by {self.renderer}")
        return (table.constant or 0.0) * self.picture(colour.texture.texture)

    def refuse_other_luminaires(self, luminaire: scene_pb2.Luminaire, group: int, place: str) -> None:
        """Tell of light that only our luminaires give."""
        if group:
            self.findings.lost(place, "luminaires in groups can't be exported")
        if luminaire.WhichOneof("profile"):
            self.findings.lost(
                f"{place}.profile",
                f"a luminaire whose radiance depends on direction is not supported by {self.renderer}",
            )
        if luminaire.radiance.HasField("texture"):
            self.findings.lost(f"{place}.radiance", "a textured luminaire can't be exported")

    def refuse_other_sensors(self) -> None:
        """Tell of what a sensor has that only ours have."""
        sensor = self.message.sensor
        if sensor.later_poses:
            self.findings.lost("$.sensor.motion", "motion can't be exported")
        if sensor.aperture_blades:
            self.findings.lost("$.sensor.aperture", "a lens opening with corners can't be exported")
        if sensor.further_responses:
            self.findings.lost("$.sensor.responses", "further responses can't be exported")
        within = range_of(sensor)
        if not within.is_usual:
            self.findings.lost("$.wavelengths", f"{within} can't be exported, only {VISIBLE}")
        if sensor.HasField("quantity"):
            self.findings.lost("$.sensor.measures", "another quantity than luminance can't be exported")
            return
        standard = spectra.response(within=within).astype(np.float32)
        curves = (sensor.response_x, sensor.response_y, sensor.response_z)
        if any(not np.array_equal(curve, standard[:, axis]) for axis, curve in enumerate(curves)):
            self.findings.lost("$.sensor.observer", "other observers than that of 1931 can't be exported")


def array(vector: scene_pb2.Vector) -> Array:
    """Three numbers."""
    return np.array([vector.x, vector.y, vector.z])


def one_alpha(roughness: scene_pb2.Roughness) -> float | None:
    """The alpha of both directions; None where they differ or vary."""
    u, v = roughness.alpha_u, roughness.alpha_v
    if "texture" in (u.WhichOneof("source"), v.WhichOneof("source")) or u.constant != v.constant:
        return None
    return float(u.constant)


def _floats(mesh: scene_pb2.Mesh) -> int:
    return _ends(mesh)[-1] if mesh.vertex_count else 0


def _ends(mesh: scene_pb2.Mesh) -> list[int]:
    """Where the parts of a mesh's blob end, counted in numbers of 32 bits."""
    steps = max(1, mesh.time_steps)
    parts = [3 * steps, 3 * steps * mesh.normals, 2 * mesh.texture_coordinates]
    return [int(end) * mesh.vertex_count for end in np.cumsum([part for part in parts if part])]


def _crossings(mesh: Triangles, point: Array) -> int:
    """How many triangles a ray from a point meets (T. Moeller and B. Trumbore 1997)."""
    a, b, c = (mesh.vertices[mesh.indices[:, corner]] for corner in range(3))
    across = np.cross(_ASKEW, c - a)
    determinant = np.einsum("ij,ij->i", b - a, across)
    hit = determinant != 0
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=hit)
    offset = point - a
    u = np.einsum("ij,ij->i", offset, across) * inverse
    turned = np.cross(offset, b - a)
    v = turned @ _ASKEW * inverse
    t = np.einsum("ij,ij->i", c - a, turned) * inverse
    return int(np.sum(hit & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)))
