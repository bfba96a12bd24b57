"""CIE general skies by their formulas, written down apart from the compiler's, and light through openings."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import numpy.typing as npt

Values = npt.NDArray[np.float64]
Point = tuple[float, float, float] | list[float]

# ISO 15469:2004 (CIE S 011/E:2003), table 1: gradation a, b; indicatrix c, d, e.
TYPES = {
    1: (4.0, -0.70, 0.0, -1.0, 0.0),
    2: (4.0, -0.70, 2.0, -1.5, 0.15),
    5: (0.0, -1.0, 0.0, -1.0, 0.0),
    7: (0.0, -1.0, 5.0, -2.5, 0.30),
    8: (0.0, -1.0, 10.0, -3.0, 0.45),
    12: (-1.0, -0.32, 10.0, -3.0, 0.45),
}
"""The traditional overcast sky of Moon and Spencer (1942), L = (1 + 2 cos z) / 3, is 16."""

SUN = (0.0, 0.5, 3**0.5 / 2)
"""At 60 degrees above +y; z is up."""


def luminance(kind: int, directions: Values) -> Values:
    """Of unit vectors, shape (..., 3), above the horizon, over the zenith's; 0 below it."""
    z = directions[..., 2]
    above = z > 0.0
    z = np.where(above, z, 1.0)
    if kind == 16:
        return np.where(above, (1.0 + 2.0 * z) / 3.0, 0.0)
    a, b, c, d, e = TYPES[kind]

    def indicatrix(angle: Values) -> Values:
        tail: Values = 1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2)) + e * np.cos(angle) ** 2
        return tail

    from_sun = np.arccos(np.clip(directions @ np.array(SUN), -1.0, 1.0))
    gradation = (1.0 + a * np.exp(b / z)) / (1.0 + a * np.exp(b))
    at_zenith = indicatrix(np.asarray(np.pi / 6))
    return np.where(above, gradation * indicatrix(from_sun) / at_zenith, 0.0)


@lru_cache(maxsize=16)
def horizontal_illuminance(kind: int) -> float:
    """Of open ground, for a zenith of 1: the integral of luminance times cosine over the upper
    half-sphere."""
    nodes, weights = np.polynomial.legendre.leggauss(400)
    z, dz = 0.5 * (nodes + 1.0), 0.5 * weights
    azimuth = (np.arange(800) + 0.5) * 2.0 * np.pi / 800
    sine = np.sqrt(1.0 - z**2)[:, None]
    directions = np.stack(
        [sine * np.cos(azimuth), sine * np.sin(azimuth), np.broadcast_to(z[:, None], (400, 800))], axis=-1
    )
    return float((luminance(kind, directions).mean(axis=1) * 2.0 * np.pi * z * dz).sum())


def through_opening(
    kind: int,
    point: Point,
    normal: Point,
    corner: Point,
    edges: tuple[Point, Point],
    passes: Callable[[Values], Values] | None = None,
) -> float:
    """Illuminance of a point by the sky that it sees through a rectangle, for a zenith of 1; `passes`: what a
    pane in it lets through, by the cosine to its normal. Gauss quadrature in 100 x 100 points."""
    nodes, weights = np.polynomial.legendre.leggauss(100)
    at, weight = 0.5 * (nodes + 1.0), 0.5 * weights
    u, v = (np.array(edge, dtype=float) for edge in edges)
    across = np.cross(u, v)
    area = float(np.linalg.norm(across))
    places = np.array(corner) + at[:, None, None] * u + at[None, :, None] * v
    to = places - np.array(point)
    distance = np.sqrt((to**2).sum(axis=-1))
    directions = to / distance[..., None]
    cosine = np.clip(directions @ np.array(normal), 0.0, None)
    tilt = np.abs(directions @ (across / area))
    seen = luminance(kind, directions) * cosine * tilt / distance**2
    if passes is not None:
        seen = seen * passes(tilt)
    return float((seen * weight[:, None] * weight[None, :]).sum()) * area
