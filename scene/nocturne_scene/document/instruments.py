"""Illuminance meters at points, on grids and on faces of surfaces, as written in a scene document."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, Name, PositiveLength, Switch, Text, Vector
from nocturne_scene.document.node import Node, problem_at
from nocturne_scene.document.shapes import length, parallel

Measures = Literal["plane", "cylindrical", "semicylindrical", "hemispherical", "spherical", "fluence"]
_Count = Annotated[int, Field(strict=True, ge=1, le=bounds.METERS)]
_SQUARE = 2.0
"""Ratio of the sides of an area from which on EN 12464-1 takes the shorter one."""


class MeterGrid(Node):
    """Points in the middles of the cells of a rectangle.

    Seen from the side that `right` x `up` points to, the film is its plan: +x along `right`, +y along `up`.
    Without `columns` and `rows` the cells are those of EN 12464-1:2021, 5.4: at most p = 0.2 x 5^(log10 d)
    metres, where d is the longer side of the area, or the shorter one if the longer is twice as long or
    more.
    """

    corner: Vector = Field(description="The lower left corner of the rectangle, m.")
    right: Vector = Field(description="From there to the lower right one, m.")
    up: Vector = Field(description="From there to the upper left one, m.")
    border: Annotated[Finite, Field(ge=0)] = Field(
        default=0.0, description="Width of the band along all edges that is left out, m; by the standard 0.5."
    )
    columns: _Count | None = Field(default=None, description="Number of cells along `right`.")
    rows: _Count | None = Field(default=None, description="Number of cells along `up`.")

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        for name in ("right", "up"):
            if length(getattr(self, name)) <= 2.0 * self.border:
                raise problem_at(f".{name}", "nothing of this side is left inside the border")
        if parallel(self.right, self.up):
            raise problem_at(".up", "up is parallel to right")
        if (self.columns is None) != (self.rows is None):
            raise problem_at(".rows", "expected both columns and rows, or none of them")
        columns, rows = self.cells()
        if columns * rows > bounds.METERS:
            raise problem_at("", f"has {columns} x {rows} points; at most {bounds.METERS} together")
        return self

    def cells(self) -> tuple[int, int]:
        """Columns and rows."""
        if self.columns is not None and self.rows is not None:
            return self.columns, self.rows
        sides = length(self.right) - 2.0 * self.border, length(self.up) - 2.0 * self.border
        longer = max(sides)
        d = longer if longer < _SQUARE * min(sides) else min(sides)
        p = min(0.2 * 5.0 ** math.log10(d), 10.0)
        spacing = d / max(1, round(d / p))
        columns, rows = (max(1, round(side / spacing)) for side in sides)
        return columns, rows


class Faces(Node):
    """Faces of a surface, each with a meter in its middle; or points spread evenly over the whole surface.

    A mesh's faces are its triangles, in the mesh's order; a box has six, a quad and a disc are one. Spheres
    have none.
    """

    surface: Text = Field(
        description="Name of a surface of `$.surfaces` that is at rest, and that no other one has."
    )
    count: _Count = Field(description="How many meters there are.")
    first: Annotated[int, Field(strict=True, ge=0)] = Field(
        default=0, description="Number of the first face, from 0; the next ones follow."
    )
    spread: Switch = Field(
        default=False,
        description="`true`: each meter stands for the same part of the surface's area, whatever its faces "
        "are, so that the mean reading is that of the surface.",
    )
    side: Literal["front", "back"] = Field(
        default="front", description="`front`: the side that the faces' normals point to."
    )
    distance: PositiveLength = Field(
        default=1e-4, description="From a face to its meter, m; more than what rounding moves surfaces."
    )

    @model_validator(mode="after")
    def _has_a_use(self) -> Self:
        if self.spread and self.first:
            raise problem_at(".first", "points that are spread over a surface have no first face")
        return self


class Instrument(Node):
    """Meters of one kind, at `points`, on a `grid` or on `faces`.

    What a body measures is the mean of what planes on its surface would (EN 12665:2018); under an even
    luminance L all get pi L, but for the fluence rate, 4 pi L.
    """

    name: Name = Field(description="Name of its readings.")
    points: Annotated[list[Vector], Field(min_length=1, max_length=bounds.METERS)] | None = Field(
        default=None, description="Where, m."
    )
    grid: MeterGrid | None = Field(default=None, description="Where, instead of `points`.")
    faces: Faces | None = Field(default=None, description="Where, instead of `points`.")
    normals: Annotated[list[Vector], Field(min_length=1, max_length=bounds.METERS)] | None = Field(
        default=None, description="A normal for each of `points`, instead of one `normal` for all of them."
    )
    measures: Measures = Field(
        default="plane",
        description="`plane`: on one side of a plane, as at an eye; `cylindrical`: around an axis (E_z of "
        "EN 12464-1); `semicylindrical`: around the half of one that faces `facing`; `hemispherical`: on a "
        "dome; `spherical`: on a sphere; `fluence`: four times that, the integral over all directions.",
    )
    normal: Vector | None = Field(
        default=None,
        description="Of the plane or of the dome's base; of cylinders the axis. Default: of a grid "
        "`right` x `up`, of faces their own normals, of points and of cylinders y.",
    )
    facing: Vector | None = Field(
        default=None, description="Only for `semicylindrical`: the direction that its middle faces."
    )

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if sum(where is not None for where in (self.points, self.grid, self.faces)) != 1:
            raise problem_at(".points", "expected one of points, grid and faces")
        if self.normal is not None and length(self.normal) < bounds.MIN_LENGTH:
            raise problem_at(".normal", "has no length")
        self._check_normals()
        if (self.facing is not None) != (self.measures == "semicylindrical"):
            raise problem_at(".facing", 'expected together with "semicylindrical", and only then')
        if self.facing is not None and any(parallel(self.facing, axis) for axis in self.axes()):
            raise problem_at(".facing", "is parallel to the axis")
        return self

    def _check_normals(self) -> None:
        if self.normals is None:
            return
        if self.points is None or len(self.normals) != len(self.points):
            raise problem_at(".normals", "expected one for each of points")
        if self.normal is not None:
            raise problem_at(".normals", "expected either normal or normals")
        for index, normal in enumerate(self.normals):
            if length(normal) < bounds.MIN_LENGTH:
                raise problem_at(f".normals[{index}]", "has no length")

    def axes(self) -> list[tuple[float, float, float]]:
        """Normals or axes of any length: one for each of its meters, or one for all of them."""
        return list(self.normals) if self.normals else [self.axis()]

    def axis(self) -> tuple[float, float, float]:
        """The normal or axis, of any length."""
        if self.normal is not None:
            return self.normal
        # Those of faces are known once these are.
        if self.grid is None or self.measures in ("cylindrical", "semicylindrical"):
            return (0.0, 1.0, 0.0)
        (a, b, c), (x, y, z) = self.grid.right, self.grid.up
        return (b * z - c * y, c * x - a * z, a * y - b * x)

    def middle(self) -> tuple[float, float, float]:
        """Of the grid, or of the box around the points, m; of faces the origin, as they are found later."""
        if self.faces is not None:
            return (0.0, 0.0, 0.0)
        if self.grid is None:
            x, y, z = (0.5 * (min(axis) + max(axis)) for axis in zip(*(self.points or ()), strict=True))
            return (x, y, z)
        grid = zip(self.grid.corner, self.grid.right, self.grid.up, strict=True)
        x, y, z = (corner + 0.5 * (right + up) for corner, right, up in grid)
        return (x, y, z)

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows of pixels; points and faces are one row."""
        if self.grid is not None:
            return self.grid.cells()
        return (self.faces.count if self.faces else len(self.points or ()), 1)
