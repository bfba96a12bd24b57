"""Says where a beam goes: a far screen behind a wedge that only absorbs.

The wedge has the index 1, so light goes straight through. It is thicker the higher light enters it: the
transmitted part of the screen's light gives the height. One image is traced with the wedge and one without,
with the same random numbers, so that losses at surfaces and the drawing of wavelengths cancel. Rays along the
ruler's axis that meet its middle read 0 exactly; a reading d is wrong by up to d times the beam's angle to
the axis times the wedge's slope.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tests.accuracy.tracing import Document, trace
from tests.system.images import Image

Vector = npt.NDArray[np.float64]

_FLAT: dict[str, Any] = {"roulette": "weight", "h": 1e6}
"""No roulette: where a photon goes is all the chance there is."""


@dataclass(frozen=True)
class Ruler:
    """Its middle, the direction of light that comes along its axis, up (unit vectors), half its length."""

    middle: Vector
    axis: Vector
    up: Vector
    half_length: float
    light: Any = 1.0
    """Spectral radiance of the screen."""
    slope: float = 10.0
    """Thickness of the wedge over its length. Photons start a little beyond a surface (1e-6 of the
    coordinates), and the skipped distance does not absorb; divided by the slope, it is the error of the
    reading. Light enters the wedge in the middle's plane.
    """

    @classmethod
    def at(
        cls, middle: Vector, axis: Vector, half_length: float, light: Any = 1.0, slope: float = 10.0
    ) -> "Ruler":
        """In the plane x = 0; up is the axis turned a quarter from z to y."""
        return cls(middle, axis, np.array([0.0, axis[2], -axis[1]]), half_length, light, slope)

    def read(self, document: Document, folder: Path, edge: tuple[int, int], samples: int) -> "Reading":
        """Where the light goes that `document`'s sensor sees; it may have no other light."""
        images = []
        for wedge in ([], [self._wedge()]):
            surfaces = [*document["surfaces"], self._screen(), *wedge]
            tracing = {**_FLAT, **document.get("tracing", {})}
            whole = {**document, "surfaces": surfaces, "tracing": tracing}
            images.append(trace(whole, folder, edge, samples))
        return Reading(self.half_length, *images)

    @property
    def _thickness(self) -> float:
        return 2 * self.half_length * self.slope

    def _screen(self) -> Document:
        up, width = 2 * self.half_length * self.up, 2 * self.half_length * np.array([1.0, 0.0, 0.0])
        corner = self.middle + 0.51 * self._thickness * self.axis - 0.5 * (up + width)
        # The normal faces the light.
        edges = (up, width) if np.dot(np.cross(up, width), self.axis) < 0 else (width, up)
        shape = {"type": "quad", "corner": corner.tolist()}
        shape |= {"edge_u": edges[0].tolist(), "edge_v": edges[1].tolist()}
        return {"shape": shape, "kernel": _BLACK, "luminaire": {"radiance": self.light}}

    def _wedge(self) -> Document:
        thickness = self._thickness
        back = self.middle + 0.5 * thickness * self.axis
        low, high = back - self.half_length * self.up, back + self.half_length * self.up
        triangle = [low, high, high - thickness * self.axis]
        return {
            "shape": extruded(triangle, 2.2 * self.half_length),
            "kernel": {"type": "dielectric", "index": 1.0, "absorption": 1.0 / thickness},
        }


@dataclass(frozen=True)
class Reading:
    """The two images of a ruler."""

    half_length: float
    plain: Image
    wedged: Image

    def place(self) -> Vector:
        """Where the light of each pixel meets the ruler, m from the middle; shape (height, width)."""
        assert np.all(self.plain.y > 0.0), "light misses the ruler"
        return self.half_length * (-2.0 * np.log(self.wedged.y / self.plain.y) - 1.0)


_BLACK = {"type": "lambertian", "reflectance": 0.0}


def extruded(polygon: list[Vector], width: float) -> Document:
    """A prism along x over a convex polygon in the plane x = 0, as a closed mesh with normals outwards."""
    count = len(polygon)
    vertices = [point + np.array([side * width / 2, 0.0, 0.0]) for side in (-1, 1) for point in polygon]
    triangles = [[0, i, i + 1] for i in range(1, count - 1)]
    triangles += [[count, count + i + 1, count + i] for i in range(1, count - 1)]
    for i in range(count):
        j = (i + 1) % count
        triangles += [[i, count + i, count + j], [i, count + j, j]]
    area = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])[0]
    if area > 0:  # the first polygon, at negative x, must look towards negative x
        triangles = [[a, c, b] for a, b, c in triangles]
    return {"type": "mesh", "vertices": [v.tolist() for v in vertices], "triangles": triangles}
