"""Parts of documents that several cases share. Lengths in metres, lights of flat spectra."""

from collections.abc import Sequence
from math import cos, radians, sin, sqrt
from typing import Any

import numpy as np
from nocturne_scene.validation.documents import BLACK, box, diffuse, quad, surface

from tests.accuracy.tracing import Document

Point = Sequence[float]

__all__ = ["BLACK", "beam", "box", "diffuse", "film", "fresnel", "furnace", "lit", "quad", "surface", "walls"]


def film(position: Point, normal: Point, height: float, **more: Any) -> Document:
    """An irradiance meter: under an even light of radiance 1 it reads pi."""
    made: Document = {"type": "irradiance_meter", "position": list(position), "normal": list(normal)}
    return made | {"height": height} | more


def beam(degrees: float, height: float = 1e-3, distance: float = 1.0) -> Document:
    """A thin camera that looks at the origin at an angle to the z axis: reads the radiance."""
    angle = radians(degrees)
    position = [0.0, distance * sin(angle), distance * cos(angle)]
    made: Document = {"type": "orthographic", "position": position, "look_at": [0, 0, 0]}
    return made | {"up": [1, 0, 0], "height": height}


def walls(corner: Point, edge: float, kernel: Document, radiance: float = 0.0) -> list[Document]:
    """A cube of six squares that look inwards and may emit."""
    x, y, z = np.eye(3) * edge
    low = np.array(corner, dtype=float)
    sides = [(low, y, z), (low + x, z, y), (low, z, x), (low + y, x, z), (low, x, y), (low + z, y, x)]
    return [surface(quad(at.tolist(), u.tolist(), v.tolist()), kernel, radiance) for at, u, v in sides]


def furnace(
    albedo: float, edge: float = 1.0, corner: Point = (0.0, 0.0, 0.0), radiance: float = 1.0
) -> Document:
    """A film in the middle of a cube whose walls scatter and emit: reads pi radiance / (1 - albedo)."""
    middle = [c + 0.5 * edge for c in corner]
    sensor = film(middle, [0, 0, 1], 0.5 * edge)
    return lit(sensor, walls(corner, edge, diffuse(albedo), radiance), sky=None)


def lit(sensor: Document, surfaces: list[Document], sky: float | None = 1.0, **more: Any) -> Document:
    """A document; with light of radiance `sky` from everywhere."""
    document: Document = {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, "tracing": {}}
    if sky is not None:
        document["environment"] = {"radiance": sky}
    return document | more


def fresnel(degrees: float, index: float) -> float:
    """Reflectance of a smooth dielectric for unpolarised light from vacuum. Born and Wolf, 1.5.2."""
    c = cos(radians(degrees))
    t = sqrt(1.0 - (1.0 - c * c) / index**2)
    s, p = (c - index * t) / (c + index * t), (index * c - t) / (index * c + t)
    return 0.5 * (s * s + p * p)


FURNACE_SOURCE = "energy balance: irradiance pi L / (1 - albedo) in a closed box"
"""Of `furnace`."""
