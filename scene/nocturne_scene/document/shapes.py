"""Shapes as written in a scene document, and how they are placed."""

import re
from pathlib import PurePosixPath
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import (
    MESH_FORMATS,
    AssetReference,
    Coordinate,
    MeshFormat,
    PositiveLength,
    Switch,
    Triangle,
    Vector,
)
from nocturne_scene.document.medium_interfaces import MediumName
from nocturne_scene.document.node import ByType, Node, problem_at, quoted_list

_Coordinates = tuple[Coordinate, Coordinate]
DIGEST_PREFIX = "sha256:"
_DIGEST = re.compile(r"sha256:[0-9a-f]{64}")

# Sine of the smallest angle that still spans an area in float32 (24 bits of mantissa).
_MIN_SINE = 1e-6


def length(vector: tuple[float, float, float]) -> float:
    """Euclidean length."""
    return float(np.linalg.norm(vector))


def parallel(a: tuple[float, float, float], b: tuple[float, float, float]) -> bool:
    """Whether two directions span no area, also when one of them is zero."""
    return length(tuple(np.cross(a, b))) <= _MIN_SINE * length(a) * length(b)


_SMOOTH = Field(
    default=False,
    description="Shade with normals that are interpolated between vertices: those of the mesh where it has "
    "them, else the mean of the adjoining triangles'. `false`: flat triangles.",
)


class InlineMesh(Node):
    """Triangles written in the document itself; for more than a few thousand, use a file."""

    type: Literal["mesh"]
    vertices: Annotated[list[Vector], Field(min_length=3, fail_fast=True)] = Field(
        description="Positions `[x, y, z]`."
    )
    triangles: Annotated[list[Triangle], Field(min_length=1, fail_fast=True)] = Field(
        description="Triples of indices into `vertices`, from 0. Counter-clockwise seen from the "
        "side that the normal points to."
    )
    normals: Annotated[list[Vector], Field(fail_fast=True)] | None = Field(
        default=None, description="A direction for each vertex, for `smooth`."
    )
    texture_coordinates: Annotated[list[_Coordinates], Field(fail_fast=True)] | None = Field(
        default=None, description="`[u, v]` for each vertex."
    )
    smooth: Switch = _SMOOTH

    @model_validator(mode="after")
    def _one_for_each_vertex(self) -> Self:
        for name in ("normals", "texture_coordinates"):
            values = getattr(self, name)
            if values is not None and len(values) != len(self.vertices):
                raise problem_at(f".{name}", f"has {len(values)} entries for {len(self.vertices)} vertices")
        return self

    @model_validator(mode="after")
    def _indices_in_range(self) -> Self:
        count = len(self.vertices)
        for number, triangle in enumerate(self.triangles):
            for corner, index in enumerate(triangle):
                if index >= count:
                    raise problem_at(
                        f".triangles[{number}][{corner}]",
                        f"vertex {index} does not exist; there are {count} vertices, counted from 0",
                    )
        return self


class AssetMesh(Node):
    """Triangles from a file: Wavefront OBJ, PLY, STL, glTF 2.0 or GLB.

    Its geometry is used, its texture coordinates where they are needed (of OBJ and PLY files), and its
    normals if `smooth`.

    A file holds everything itself: material libraries are ignored, and a glTF file with buffers in other
    files is refused (GLB and embedded buffers are fine). Polygons are split into triangles, all parts are
    merged.
    """

    type: Literal["mesh"]
    asset: AssetReference = Field(
        description="`sha256:` and 64 hexadecimal digits of an uploaded file. The command line also "
        "takes a path relative to the "
        "document; it uploads the file and puts the digest here."
    )
    format: MeshFormat | None = Field(
        default=None,
        description="Format of the file. Needed with a digest; with a path the default is the extension.",
    )
    smooth: Switch = _SMOOTH

    @model_validator(mode="after")
    def _format_is_known(self) -> Self:
        if self.asset.startswith(DIGEST_PREFIX) and not _DIGEST.fullmatch(self.asset):
            raise problem_at(".asset", f'expected "{DIGEST_PREFIX}" and 64 lower-case hexadecimal digits')
        self.resolved_format()
        return self

    def resolved_format(self) -> MeshFormat:
        """The format as given, else by the extension of the path."""
        if self.format is not None:
            return self.format
        extension = PurePosixPath(self.asset).suffix.lower().removeprefix(".")
        if extension in MESH_FORMATS:
            return MESH_FORMATS[extension]
        raise problem_at(
            ".format",
            f"missing, and the asset's name does not tell; expected one of {quoted_list(list(MESH_FORMATS))}",
        )


class Quad(Node):
    """The parallelogram `corner + s edge_u + t edge_v` for s and t in [0, 1].

    Its normal points along `edge_u` x `edge_v`.
    """

    type: Literal["quad"]
    corner: Vector = Field(description="A corner.")
    edge_u: Vector = Field(description="From the corner along one side.")
    edge_v: Vector = Field(description="From the corner along the other side.")

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        for name in ("edge_u", "edge_v"):
            if length(getattr(self, name)) < bounds.MIN_LENGTH:
                raise problem_at(f".{name}", "the edge has no length")
        if parallel(self.edge_u, self.edge_v):
            raise problem_at(".edge_v", "the quad has no area: edge_v is parallel to edge_u")
        return self


class Sphere(Node):
    """A sphere. Its normal points outwards.

    Texture coordinates: u is the angle about z, from x towards y, over a full turn; v goes from the lowest
    point (0) to the highest (1) in equal steps of angle, where z is up. `rotate` turns both with the surface.
    """

    type: Literal["sphere"]
    centre: Vector = Field(description="Centre.")
    radius: PositiveLength = Field(description="Radius, more than 0.")


class Disc(Node):
    """A flat disc, made of `segments` triangles around its centre.

    Its corners lie on the circle, so its area is too small by a part of 6.58 / segments²: 1.0e-4 with 256,
    6.3e-6 with 1024. Texture coordinates run from 0 to 1 across it.
    """

    type: Literal["disc"]
    centre: Vector = Field(description="Centre.")
    normal: Vector = Field(description="Direction of the normal, of any length but 0.")
    radius: PositiveLength = Field(description="Radius, more than 0.")
    segments: Annotated[int, Field(strict=True, ge=3, le=bounds.DISC_SEGMENTS)] = Field(
        default=256, description="Corners on the circle."
    )

    @model_validator(mode="after")
    def _has_normal(self) -> Self:
        if length(self.normal) < bounds.MIN_LENGTH:
            raise problem_at(".normal", "the normal has no length")
        return self


class Box(Node):
    """A box along the axes. Its normals point outwards."""

    type: Literal["box"]
    minimum: Vector = Field(description="The corner with the smallest coordinates.")
    maximum: Vector = Field(description="The corner with the largest coordinates.")

    @model_validator(mode="after")
    def _has_volume(self) -> Self:
        for axis, (low, high) in enumerate(zip(self.minimum, self.maximum, strict=True)):
            if high - low < bounds.MIN_LENGTH:
                raise problem_at(f".maximum[{axis}]", f"must be more than minimum's {low:g}, found {high:g}")
        return self


class MediumBox(Node):
    """The box around what a medium's grid holds, with room for its linear interpolation.

    It stands as the grid stands, so it has no separate placement, and no place in a group. Its normals
    point outwards.
    """

    type: Literal["medium_box"]
    medium: MediumName = Field(description="A name from `$.media`, whose `density` is a grid.")


Shape = InlineMesh | AssetMesh | Quad | Sphere | Disc | Box | MediumBox


def _mesh(value: Any, kind: str) -> type[Node] | None:
    """A mesh is one of two kinds: with "asset" it is a file, without it is inline."""
    refuse_without_size(kind)
    has_asset = "asset" in value if isinstance(value, dict) else isinstance(value, AssetMesh)
    return None if kind != "mesh" else AssetMesh if has_asset else InlineMesh


def refuse_without_size(kind: Any) -> None:
    """Raise an error if `kind` is the type of a lamp that has no size."""
    if kind in ("point", "spot", "directional"):
        raise problem_at(
            ".type",
            f'a lamp needs a size, and a "{kind}" light has none; expected '
            + (
                "an entry of $.distant with an angular diameter"
                if kind == "directional"
                else "a surface with a luminaire, such as a small sphere or disc"
            ),
        )


ShapeDefinition = Annotated[Shape, ByType(_mesh)]
