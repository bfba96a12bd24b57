"""Lamps without a size, as small lamps of the same power."""

import math

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.photometry.ies import Photometry
from nocturne_scene.photometry.ies import write as write_photometry

Direction = NDArray[np.float64]

# No ray of another renderer meets a lamp without a size, whether it comes from the camera or a mirror.
UNSEEN = "camera_and_mirrors"


def point(position: Direction, radius: float, intensity: Json, name: str) -> Json:
    """A sphere that has the same intensity in all directions, W sr-1 nm-1."""
    return {
        "name": name,
        "shape": {"type": "sphere", "centre": position.tolist(), "radius": radius},
        "kernel": {"type": "null"},
        "luminaire": {
            "radiance": colours.scaled(intensity, 1 / (math.pi * radius**2)),
            "hidden_from": UNSEEN,
        },
    }


def far(direction: list[float], degrees: float, irradiance: Json) -> Json:
    """A disc at infinity that has the same irradiance, face on; `direction` points at it."""
    return {
        "direction": direction,
        "angular_diameter_degrees": degrees,
        "irradiance": irradiance,
        "hidden_from": UNSEEN,
    }


def spot(
    writer: SceneWriter,
    position: Direction,
    axis: Direction,
    radius: float,
    intensity: Json,
    profile: tuple[Direction, Direction],
    name: str,
) -> Json:
    """A sphere whose intensity falls with the angle from `axis`.

    `profile`: degrees from 0 to 180, increasing, and the part of the intensity at each, straight in between.
    """
    degrees, part = profile
    candela = colours.luminance_of(intensity) * part
    lamp = Photometry(vertical=degrees, horizontal=np.array([0.0]), candela=candela[None])
    asset = writer.file(
        f"lamps/{name}-{len(writer.document.get('surfaces', []))}.ies", write_photometry(lamp)
    )
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    return {
        "name": name,
        "shape": {"type": "sphere", "centre": position.tolist(), "radius": radius},
        "kernel": {"type": "null"},
        "luminaire": {
            "radiance": intensity,
            "profile": {"asset": asset, "axis": axis.tolist(), "zero": across.tolist()},
            "hidden_from": UNSEEN,
        },
    }
