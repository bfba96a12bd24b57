"""The scene compiler.

A checked document in, the tracer's message and its mesh blobs out, addressed by content.
"""

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import Generic, TypeVar

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_coordinator.blobs import BlobStore
from nocturne_coordinator.errors import InputError, NotFound, Problem
from nocturne_coordinator.scene import bounds, spectra
from nocturne_coordinator.scene.checks import resolve_spectrum
from nocturne_coordinator.scene.mesh_headers import UnusableMeshError
from nocturne_coordinator.scene.meshes import BadVertexError, Triangles, inline_mesh, load_mesh, pack_mesh
from nocturne_coordinator.scene.model import Lambertian, Luminaire, SceneDocument, Surface, Tracing
from nocturne_coordinator.scene.placement import placement_of
from nocturne_coordinator.scene.problems import path
from nocturne_coordinator.scene.sensors import compile_sensor, vector
from nocturne_coordinator.scene.shape_model import DIGEST_PREFIX, AssetMesh, InlineMesh, Quad, Sphere
from nocturne_coordinator.scene.spectrum_model import Spectrum

# Layout of CompiledScene; raised with every change that an older worker would misread.
FORMAT = 1

_SEQUENCES = {
    "sobol": scene_pb2.SAMPLE_SEQUENCE_SOBOL,
    "independent": scene_pb2.SAMPLE_SEQUENCE_INDEPENDENT,
}
_ROULETTES = {
    "weight": scene_pb2.ROULETTE_WEIGHT,
    "albedo": scene_pb2.ROULETTE_ALBEDO,
}


@dataclass(frozen=True)
class CompiledOutput:
    """Where the compiled scene is, and which parts of the document it does without, in words with their
    places.
    """

    scene_sha256: str
    dropped: list[str]


def compile_scene(document: SceneDocument, blobs: BlobStore) -> CompiledOutput:
    """Compile a document and put the scene and its meshes into the blob store.

    Equal documents give equal bytes. Raises InputError with at most `bounds.PROBLEMS` problems, and then
    leaves nothing behind: blobs are written last, when all of them are there.
    """
    compilation = _Compilation(document, blobs)
    message = compilation.run()
    for packed in compilation.packed.values():
        blobs.put(packed)
    scene_sha256 = blobs.put(message.SerializeToString(deterministic=True))
    return CompiledOutput(scene_sha256, compilation.dropped)


_Message = TypeVar("_Message", scene_pb2.Spectrum, scene_pb2.Kernel)


class _Pool(Generic[_Message]):
    """Messages without duplicates, in order of first use."""

    def __init__(self) -> None:
        self._index_by_bytes: dict[bytes, int] = {}
        self.messages: list[_Message] = []

    def index_of(self, message: _Message) -> int:
        """Return the index of an equal message, added if there is none."""
        key = message.SerializeToString(deterministic=True)
        if key not in self._index_by_bytes:
            self._index_by_bytes[key] = len(self.messages)
            self.messages.append(message)
        return self._index_by_bytes[key]


class _Compilation:
    """One run of the compiler; `packed` and `dropped` are its results besides the message."""

    def __init__(self, document: SceneDocument, blobs: BlobStore) -> None:
        self.packed: dict[bytes, bytes] = {}
        self.dropped: list[str] = []
        self._document = document
        self._blobs = blobs
        self._problems: list[Problem] = []
        self._spectra: _Pool[scene_pb2.Spectrum] = _Pool()
        self._kernels: _Pool[scene_pb2.Kernel] = _Pool()
        self._loaded: dict[tuple[str, str], Triangles] = {}
        self._used: set[tuple[str, str]] = set()

    def run(self) -> scene_pb2.CompiledScene:
        """Return the compiled scene; raises InputError."""
        document = self._document
        message = scene_pb2.CompiledScene(format=FORMAT, sensor=compile_sensor(document.sensor))
        for index, surface in enumerate(document.surfaces):
            place = path(("surfaces", index))
            message.surfaces.append(self._surface(surface, place))
            message.luminaires.extend(self._luminaires(surface.luminaire, index, f"{place}.luminaire"))
            if len(self._problems) >= bounds.PROBLEMS:
                break
        if not message.luminaires and not self._problems:
            self._problems.append(
                Problem("$.surfaces", "no luminaire emits visible light, so the image would be black")
            )
        if self._problems:
            raise InputError(islice(self._problems, bounds.PROBLEMS))
        message.spectra.extend(self._spectra.messages)
        message.kernels.extend(self._kernels.messages)
        message.tracing.CopyFrom(self._tracing(document.tracing))
        self._report_unused()
        return message

    def _surface(self, surface: Surface, place: str) -> scene_pb2.Surface:
        message = scene_pb2.Surface(kernel=self._kernel(surface.kernel))
        with self._problems_at(f"{place}.shape"):
            match surface.shape:
                case Quad():
                    message.quad.CopyFrom(_quad(surface, surface.shape))
                case Sphere():
                    message.sphere.CopyFrom(_sphere(surface, surface.shape))
                case InlineMesh():
                    mesh = inline_mesh(surface.shape.vertices, surface.shape.triangles)
                    message.mesh.CopyFrom(self._mesh(mesh, surface, place, vertices=".vertices"))
                case AssetMesh():
                    with self._problems_at(f"{place}.shape.asset"):
                        mesh = self._asset(surface.shape)
                        message.mesh.CopyFrom(self._mesh(mesh, surface, place, vertices=None))
        return message

    @contextmanager
    def _problems_at(self, place: str) -> Iterator[None]:
        """Note what can't be used and go on with the next thing."""
        try:
            yield
        except _MisplacedError as error:
            self._problems.append(Problem(place + error.suffix, str(error)))
        except (UnusableMeshError, spectra.NotCompilableError, NotFound) as error:
            self._problems.append(Problem(place, str(error)))

    def _asset(self, shape: AssetMesh) -> Triangles:
        if not shape.asset.startswith(DIGEST_PREFIX):
            raise UnusableMeshError(
                f'expected "{DIGEST_PREFIX}" and the digest of an uploaded file; the service has no paths'
            )
        key = (shape.asset, shape.resolved_format())
        if key not in self._loaded:
            file = self._blobs.path(shape.asset.removeprefix(DIGEST_PREFIX))
            self._loaded[key] = load_mesh(file, shape.resolved_format())
        return self._loaded[key]

    def _mesh(self, mesh: Triangles, surface: Surface, place: str, vertices: str | None) -> scene_pb2.Mesh:
        """Pack a mesh; `vertices` leads to the list that its vertices stand in, if they do."""
        try:
            packed = pack_mesh(mesh, placement_of(surface))
        except BadVertexError as error:
            if vertices is None:
                raise
            raise _MisplacedError(f"{vertices}[{error.index}]", error.reason) from None
        if packed.dropped_triangles:
            self.dropped.append(f"{place}.shape: {packed.dropped_triangles} triangles without an area")
        digest = hashlib.sha256(packed.blob).digest()
        self.packed[digest] = packed.blob
        return scene_pb2.Mesh(
            blob=digest, vertex_count=packed.vertex_count, triangle_count=packed.triangle_count
        )

    def _kernel(self, reference: str | Lambertian) -> int:
        if isinstance(reference, str):
            self._used.add(("kernels", reference))
            reference = self._document.kernels[reference]
        reflectance = self._spectra.index_of(spectra.reflectance(self._resolve(reference.reflectance)))
        return self._kernels.index_of(
            scene_pb2.Kernel(lambertian=scene_pb2.Lambertian(reflectance=reflectance))
        )

    def _resolve(self, reference: str | float | Spectrum) -> Spectrum:
        if isinstance(reference, str):
            self._used.add(("spectra", reference))
        return resolve_spectrum(self._document, reference)

    def _luminaires(
        self, luminaire: Luminaire | None, surface: int, place: str
    ) -> Iterator[scene_pb2.Luminaire]:
        """Yield the luminaire, unless there is none or it emits nothing."""
        if luminaire is None:
            return
        with self._problems_at(f"{place}.radiance"):
            radiance = spectra.radiance(self._resolve(luminaire.radiance))
            if spectra.is_black(radiance):
                self.dropped.append(f"{place}: emits no visible light")
                return
            index = self._spectra.index_of(radiance)
            yield scene_pb2.Luminaire(surface=surface, radiance=index, two_sided=luminaire.two_sided)

    def _tracing(self, tracing: Tracing) -> scene_pb2.Tracing:
        weights = np.array([tracing.mixture.kernel, tracing.mixture.luminaires, tracing.mixture.uniform])
        if all(
            spectra.is_black(self._spectra.messages[kernel.lambertian.reflectance])
            for kernel in self._kernels.messages
        ):
            self.dropped.append(
                "$.tracing.mixture: no surface scatters light, so no direction is ever chosen"
            )
            weights = np.array([1.0, 0.0, 0.0])
        kernel, luminaires, uniform = (float(weight) for weight in weights / weights.sum())
        return scene_pb2.Tracing(
            h=tracing.h,
            roulette=_ROULETTES[tracing.roulette],
            maximum_depth=tracing.maximum_depth,
            weight_kernel=kernel,
            weight_luminaires=luminaires,
            weight_uniform=uniform,
            sequence=_SEQUENCES[tracing.sequence],
            seed=tracing.seed,
        )

    def _report_unused(self) -> None:
        names = {"spectra": set(self._document.spectra), "kernels": set(self._document.kernels)}
        for collection, entries in names.items():
            unused = sorted(name for name in entries if (collection, name) not in self._used)
            self.dropped.extend(f"{path((collection, name))}: nothing uses it" for name in unused)


class _MisplacedError(Exception):
    """A part of a shape can't be used where its surface puts it.

    `suffix` leads from the shape to the part.
    """

    def __init__(self, suffix: str, message: str) -> None:
        self.suffix = suffix
        super().__init__(message)


def _quad(surface: Surface, quad: Quad) -> scene_pb2.Quad:
    placement = placement_of(surface)
    edge_u, edge_v = placement.directions(np.array(quad.edge_u)), placement.directions(np.array(quad.edge_v))
    _check_length(".edge_u", float(np.linalg.norm(edge_u)))
    _check_length(".edge_v", float(np.linalg.norm(edge_v)))
    corner = placement.points(np.array(quad.corner))
    _check_distance(".corner", corner)
    return scene_pb2.Quad(corner=vector(corner), edge_u=vector(edge_u), edge_v=vector(edge_v))


def _sphere(surface: Surface, sphere: Sphere) -> scene_pb2.Sphere:
    centre = placement_of(surface).points(np.array(sphere.centre))
    radius = sphere.radius * surface.scale
    _check_distance(".centre", centre)
    _check_length(".radius", radius)
    return scene_pb2.Sphere(centre=vector(centre), radius=radius)


def _check_length(suffix: str, length: float) -> None:
    if not bounds.SMALLEST_LENGTH <= length <= bounds.LENGTH:
        raise _MisplacedError(
            suffix,
            f"is {length:g} m long once scaled; expected {bounds.SMALLEST_LENGTH:g} to {bounds.LENGTH:g} m",
        )


def _check_distance(suffix: str, point: NDArray[np.float64]) -> None:
    if not np.all(np.abs(point) <= bounds.LENGTH):
        raise _MisplacedError(suffix, f"is farther than {bounds.LENGTH:g} m from the origin once placed")
