"""Closed forms of light: configuration factors, Lambert's polygons, Fresnel's plates.

Numbers such as C-41 are those of J. R. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors".
"""

from collections.abc import Sequence
from math import atan, log, pi, sqrt

import numpy as np

Point = Sequence[float]


def coaxial_discs(first: float, second: float, distance: float) -> float:
    """Part of the first disc's light that reaches the second, by their radii (C-41)."""
    r1, r2 = first / distance, second / distance
    x = 1.0 + (1.0 + r2**2) / r1**2
    return 0.5 * (x - sqrt(x**2 - 4.0 * (r2 / r1) ** 2))


def parallel_rectangles(width: float, length: float, distance: float) -> float:
    """Of two alike that face each other (C-11)."""
    x, y = width / distance, length / distance
    a, b = sqrt(1.0 + x**2), sqrt(1.0 + y**2)
    return (2.0 / (pi * x * y)) * (
        log(a * b / sqrt(1.0 + x**2 + y**2))
        + x * b * atan(x / b)
        + y * a * atan(y / a)
        - x * atan(x)
        - y * atan(y)
    )


def perpendicular_rectangles(first: float, second: float, edge: float) -> float:
    """From a rectangle edge x first to one edge x second, with the edge in common (C-14)."""
    h, w = second / edge, first / edge
    both = h**2 + w**2
    logarithm = log(
        (1.0 + w**2)
        * (1.0 + h**2)
        / (1.0 + both)
        * (w**2 * (1.0 + both) / ((1.0 + w**2) * both)) ** (w**2)
        * (h**2 * (1.0 + both) / ((1.0 + h**2) * both)) ** (h**2)
    )
    angles = w * atan(1.0 / w) + h * atan(1.0 / h) - sqrt(both) * atan(1.0 / sqrt(both))
    return (angles + 0.25 * logarithm) / (pi * w)


def sphere_to_disc(distance: float, radius: float) -> float:
    """From a sphere to a disc whose axis goes through it, by the distance of the centres; any sphere."""
    return 0.5 * (1.0 - 1.0 / sqrt(1.0 + (radius / distance) ** 2))


def point_to_disc(radius: float, height: float, aside: float = 0.0) -> float:
    """From a small surface to a disc in a plane parallel to it (B-12, off the axis B-13)."""
    if aside == 0.0:
        return radius**2 / (radius**2 + height**2)
    h, r = height / aside, radius / aside
    z = 1.0 + h**2 + r**2
    return 0.5 * (1.0 - (1.0 + h**2 - r**2) / sqrt(z**2 - 4.0 * r**2))


def point_to_polygon(point: Point, normal: Point, corners: Sequence[Point]) -> float:
    """From a small surface to a polygon wholly before it: J. H. Lambert, Photometria, 1760. Positive
    whichever way round the corners go."""
    to = np.asarray(corners, dtype=float) - np.asarray(point, dtype=float)
    total = 0.0
    for a, b in zip(to, np.roll(to, -1, axis=0), strict=True):
        across = np.cross(a, b)
        sine, cosine = float(np.linalg.norm(across)), float(a @ b)
        if sine > 0.0:
            total += float(np.arctan2(sine, cosine)) * float(across @ np.asarray(normal, dtype=float)) / sine
    return abs(total) / (2.0 * pi)


def fresnel(index: float, degrees: float) -> float:
    """Part of unpolarised light that a surface reflects, from outside."""
    cosine = float(np.cos(np.radians(degrees)))
    inside = sqrt(1.0 - (1.0 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return 0.5 * (across**2 + along**2)


def plate(index: float, degrees: float, thickness: float = 0.0) -> tuple[float, float]:
    """Transmittance and reflectance of a plate, unpolarised at every bounce, without interference; of an
    optical thickness along the normal (G. G. Stokes, Proceedings of the Royal Society 11, 1862)."""
    r = fresnel(index, degrees)
    cosine = sqrt(1.0 - float(np.sin(np.radians(degrees)) / index) ** 2)
    passed = float(np.exp(-thickness / cosine))
    through = (1.0 - r) ** 2 * passed / (1.0 - (r * passed) ** 2)
    return through, r * (1.0 + passed * through)
