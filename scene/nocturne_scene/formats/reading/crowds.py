"""Things of a scene that differ in their placement only: beyond some number they share a file.

An importer adds shapes and instances as it reads them; of each, the numbers of its placement are kept. At the
end few of a kind become entries of the document, many a file of placements or, where they are stretched or
mirrored, meshes that hold all of them.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.document import bounds
from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading import shapes, transforms
from nocturne_scene.formats.reading.findings import Findings, TooLarge
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.placements import write_placements
from nocturne_scene.meshes.triangles import Triangles

MANY = 1000
"""Of one kind, from which on they share files."""

# Entries of one document; where there would be more, kinds with fewer share files, too.
_MAX_ENTRIES = 20_000
# Of one mesh that holds many: compilers read meshes one by one.
_TRIANGLES_TOGETHER = 1_000_000
# Of all meshes that hold many: 1.5 GB.
_MAX_TRIANGLES = 50_000_000

_ROWS_BYTES = 12 * 8

_Rows = NDArray[np.float64]


@dataclass(frozen=True)
class Base:
    """A shape that is placed often."""

    name: str
    mesh: Triangles | None
    """None: it is never stretched or mirrored, so that it need not be triangles."""
    placed: Callable[[Matrix], Json] | None = None
    """Its shape where it stands; None: that of the mesh."""


class Placed(NamedTuple):
    """A base where it stands."""

    base: Base
    matrix: Matrix


def _ball(matrix: Matrix) -> Json:
    radius = float(np.linalg.norm(matrix[:3, 0]))
    return {"type": "sphere", "centre": matrix[:3, 3].tolist(), "radius": radius}


_BALL = Base("sphere", None, _ball)


def ball(centre: Matrix, radius: float) -> Placed:
    """A whole sphere that looks the same however it is turned."""
    return Placed(_BALL, transforms.translation(centre.tolist()) @ transforms.scaling([radius] * 3))


@dataclass
class _Kind:
    """All that is alike: shapes of one surface, or instances of one group."""

    surface: Json
    """Without shape and name; empty for instances."""
    base: Base
    rows: bytearray = field(default_factory=bytearray)
    """Of each the upper three rows of its matrix, in double precision."""
    names: list[str] = field(default_factory=list)
    """Of the first ones."""
    numbers: list[int] = field(default_factory=list)
    """When the first ones came."""

    def __len__(self) -> int:
        return len(self.rows) // _ROWS_BYTES

    def matrices(self) -> _Rows:
        """Shape (n, 3, 4)."""
        return np.frombuffer(self.rows, dtype=np.float64).reshape(-1, 3, 4)


class Crowds:
    """Shapes and instances of a scene, or of one group, in the order in which they come."""

    def __init__(self, writer: SceneWriter, findings: Findings) -> None:
        self._writer = writer
        self._findings = findings
        self._kinds: dict[tuple[str, int], _Kind] = {}
        self._ready: list[tuple[int, Json]] = []
        self._count = 0
        self._triangles_left = _MAX_TRIANGLES

    def add(self, surface: Json, shape: Json | Placed) -> None:
        """A surface, which has no shape yet. Raises TooLarge."""
        if not isinstance(shape, Placed):
            self._ready.append((self._count, {**surface, "shape": shape}))
            self._count += 1
        else:
            look = {key: value for key, value in surface.items() if key != "name"}
            key = json.dumps(look, sort_keys=True), id(shape.base)
            kind = self._kinds.setdefault(key, _Kind(look, shape.base))
            self._place(kind, shape.matrix, surface.get("name", ""))
        if max(len(self._ready), len(self._kinds)) > bounds.SURFACES:
            raise TooLarge(f"more than {bounds.SURFACES:,} surfaces that are not alike")

    def instance(self, group: str, matrix: Matrix) -> None:
        """All of a group once more, turned, shifted and scaled evenly."""
        key = group, 0
        if key not in self._kinds:
            self._kinds[key] = _Kind({}, Base(group, None))
        self._place(self._kinds[key], matrix, "")

    def _place(self, kind: _Kind, matrix: Matrix, name: str) -> None:
        if len(kind.numbers) < MANY:
            kind.numbers.append(self._count)
            kind.names.append(name)
        if len(kind) >= bounds.FLATTENED_INSTANCES:
            raise TooLarge(f"more than {bounds.FLATTENED_INSTANCES:,} of {kind.base.name}")
        kind.rows += matrix[:3].astype(np.float64).tobytes()
        self._count += 1

    def written(self) -> tuple[list[Json], list[Json]]:
        """Write the files, and return surfaces and instances."""
        most = self._max_apart()
        surfaces: list[tuple[int, Json]] = list(self._ready)
        instances: list[tuple[int, Json]] = []
        for kind in self._kinds.values():
            with self._findings.leaving_out():
                if not np.isfinite(kind.matrices()).all():
                    raise InputError.at(kind.base.name, "is placed by numbers that are not finite")
                if len(kind) <= most:
                    to = surfaces if kind.surface else instances
                    to.extend(zip(kind.numbers, self._apart(kind), strict=True))
                elif not kind.surface:
                    instances.append((kind.numbers[0], self._placements(kind.base.name, kind.matrices())))
                else:
                    alike, merged = self._together(kind)
                    instances += [(kind.numbers[0], each) for each in alike]
                    surfaces += [(kind.numbers[0], each) for each in merged]
        return _in_order(surfaces), _in_order(instances)

    def _max_apart(self) -> int:
        sizes = np.array([len(kind) for kind in self._kinds.values()], dtype=np.int64)
        most = MANY
        while most > 1 and int(sizes[sizes <= most].sum()) > _MAX_ENTRIES:
            most //= 2
        return most

    def _apart(self, kind: _Kind) -> Iterator[Json]:
        """Entries of a document, one by one."""
        if not kind.surface:
            yield from (_instance(kind.base.name, row) for row in _decomposed(kind.matrices()))
            return
        for rows, name in zip(kind.matrices(), kind.names, strict=True):
            matrix = np.vstack([rows, [0.0, 0.0, 0.0, 1.0]])
            named = {"name": name} if name else {}
            yield {**kind.surface, **named, "shape": self._shape(kind.base, matrix)}

    def _shape(self, base: Base, matrix: Matrix) -> Json:
        if base.placed is not None:
            return base.placed(matrix)
        if base.mesh is None:
            raise ValueError("a base has a shape or a mesh")
        return self._writer.mesh(base.name, shapes.transformed(base.mesh, matrix))

    def _together(self, kind: _Kind) -> tuple[list[Json], list[Json]]:
        """Instances of a group of one, and surfaces that hold many of those that can't be instances."""
        matrices = kind.matrices()
        even = np.full(len(kind), True) if kind.base.mesh is None else transforms.are_even(matrices)
        instances, surfaces = [], []
        if even.any():
            member = {**kind.surface, "shape": self._shape(kind.base, np.eye(4))}
            group = self._writer.name("groups", kind.base.name, [member])
            instances = [self._placements(group, matrices[even])]
        if not even.all() and kind.base.mesh is not None:
            surfaces = [{**kind.surface, "shape": each} for each in self._merged(kind.base, matrices[~even])]
        return instances, surfaces

    def _merged(self, base: Base, matrices: _Rows) -> Iterator[Json]:
        mesh = base.mesh
        if mesh is None:
            raise ValueError("there is nothing to merge")
        triangles = len(matrices) * len(mesh.indices)
        if triangles > self._triangles_left:
            said = f"{len(matrices):,} that are stretched would have {triangles:,} triangles"
            raise InputError.at(base.name, f"{said}; at most {_MAX_TRIANGLES:,} are accepted of all such")
        self._triangles_left -= triangles
        together = max(1, _TRIANGLES_TOGETHER // len(mesh.indices))
        for first in range(0, len(matrices), together):
            yield self._writer.mesh(base.name, _copies(mesh, matrices[first : first + together]))

    def _placements(self, group: str, matrices: _Rows) -> Json:
        name = self._writer.unused_file("placements", group, ".ply")
        write_placements(self._writer.folder / name, _decomposed(matrices))
        return {"group": group, "placements": {"asset": name}}


def _in_order(entries: list[tuple[int, Json]]) -> list[Json]:
    return [entry for _, entry in sorted(entries, key=lambda entry: entry[0])]


def _decomposed(matrices: _Rows) -> _Rows:
    """Placements, shape (n, 8), of matrices that are even."""
    factors = transforms.even_factors(matrices)
    table = np.zeros((len(matrices), 8))
    table[:, :3], table[:, 3] = matrices[:, :, 3], factors
    table[:, 4:7], table[:, 7] = transforms.rotations_of(matrices[:, :, :3] / factors[:, None, None])
    return table


def _instance(group: str, row: _Rows) -> Json:
    shift, scale, axis, degrees = row[:3].tolist(), float(row[3]), row[4:7].tolist(), float(row[7])
    rotate = {"rotate": {"axis": axis, "degrees": degrees}} if degrees else {}
    return {"group": group, "translate": shift, "scale": scale, **rotate}


def _copies(mesh: Triangles, matrices: _Rows) -> Triangles:
    """A mesh at all placements, as one; normals stay on their side of the triangles, also in a mirror."""
    count = len(matrices)
    linear, shifts = matrices[:, :, :3], matrices[:, :, 3]
    vertices = mesh.vertices @ linear.transpose(0, 2, 1) + shifts[:, None]
    mirrored = np.linalg.det(linear) < 0
    normals = None
    if mesh.normals is not None:
        cofactors = np.stack([np.cross(linear[:, i - 2], linear[:, i - 1]) for i in range(3)], axis=1)
        sides = np.where(mirrored, -1.0, 1.0)[:, None, None]
        normals = (mesh.normals @ (sides * cofactors).transpose(0, 2, 1)).reshape(-1, 3)
    indices = np.where(mirrored[:, None, None], mesh.indices[:, ::-1], mesh.indices)
    indices = (indices + len(mesh.vertices) * np.arange(count)[:, None, None]).reshape(-1, 3)
    coordinates = None if mesh.coordinates is None else np.tile(mesh.coordinates, (count, 1))
    return Triangles(vertices.reshape(-1, 3), indices, normals, coordinates)
