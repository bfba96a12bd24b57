"""Where the pixels of wide images look to, and their solid angles: panoramas and fisheyes.

Directions are (right, up, forward), of length 1, with the image's middle forward.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.tile_sums import Values

Projection = Literal["panorama", "equidistant", "equisolid"]
"""A panorama as our sensor of that name draws it: equal steps of azimuth and of the angle from `up`. Fisheyes
in the image's largest inscribed circle: equidistant (r = f theta), equal solid angle (r = 2 f sin(theta /
2))."""


@dataclass(frozen=True, slots=True, eq=False)
class PixelDirections:
    """Of all pixels of an image."""

    direction: Values
    """Shape (height, width, 3)."""
    solid_angle: Values
    """sr, shape (height, width); 0 outside of a fisheye's circle."""


def directions_of(
    projection: Projection, width: int, height: int, field_degrees: float = 180.0
) -> PixelDirections:
    """`field_degrees`: the full angle of a fisheye. Raises InputError for a projection or angle that is
    none."""
    if projection == "panorama":
        return _panorama(width, height)
    if projection not in get_args(Projection):
        raise InputError.at(
            "$.projection", f"{projection!r} is none; expected {', '.join(get_args(Projection))}"
        )
    if not 0.0 < field_degrees <= 360.0:
        raise InputError.at(
            "$.field", f"{field_degrees:g} degrees; a fisheye sees more than 0 and at most 360"
        )
    return _fisheye(projection, width, height, np.deg2rad(field_degrees))


def _panorama(width: int, height: int) -> PixelDirections:
    edges = np.linspace(0.0, np.pi, height + 1)
    from_up = (edges[:-1] + edges[1:]) / 2
    azimuth = (np.arange(width) + 0.5) * (2 * np.pi / width) - np.pi
    sine, cosine = np.sin(from_up)[:, None], np.cos(from_up)[:, None]
    direction = np.stack(
        [sine * np.sin(azimuth), np.broadcast_to(cosine, (height, width)), sine * np.cos(azimuth)], axis=-1
    )
    solid_angle = (2 * np.pi / width) * -np.diff(np.cos(edges))
    return PixelDirections(direction, np.broadcast_to(solid_angle[:, None], (height, width)))


def _fisheye(projection: Projection, width: int, height: int, field: float) -> PixelDirections:
    radius = min(width, height) / 2
    x = (np.arange(width) + 0.5 - width / 2) / radius
    y = (height / 2 - np.arange(height) - 0.5) / radius
    right, up = np.meshgrid(x, y)
    r = np.maximum(np.hypot(right, up), 1e-12)
    pixel = 1.0 / radius**2
    if projection == "equidistant":
        theta = r * field / 2
        solid_angle = np.sin(theta) / r * (field / 2) * pixel
    else:
        scale = np.sin(field / 4)
        theta = 2 * np.arcsin(np.minimum(1.0, r * scale))
        solid_angle = np.full_like(r, 4.0 * scale**2 * pixel)
    direction = np.stack([np.sin(theta) * right / r, np.sin(theta) * up / r, np.cos(theta)], axis=-1)
    return PixelDirections(direction, np.where(r <= 1.0, np.maximum(solid_angle, 0.0), 0.0))
