"""Slabs of media and sensors that look through them, for tests of media.

Radiances are relative to an even light of radiance 1. A sensor that looks at a slab along one direction, with
even light on one side, reads the slab's total reflectance or transmittance for light that comes from that
direction (reciprocity). A flat film on the slab's face, which looks at it, reads pi times that for diffuse
light.
"""

from pathlib import Path
from typing import Any

import numpy as np

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.scenes import BLACK, film, measured_scene, quad
from tests.accuracy.tracing import Document

WIDTH = 100.0
"""Half the edge of a slab, in free paths; at least ten thicknesses."""

EDGE = 1e-4
"""Of a reading: what a sensor sees past the slab's edge. The truths are of slabs without one."""


def medium(albedo: float, g: float = 0.0, extinction: float = 1.0, **more: Any) -> Document:
    """A grey Henyey-Greenstein medium."""
    phase = {"type": "henyey_greenstein", "g": g}
    made: Document = {"scattering": albedo * extinction, "absorption": (1.0 - albedo) * extinction}
    return made | ({"phase": phase} if g and albedo else {}) | more


def slab(thickness: float, half_edge: float, name: str = "fog", **more: Any) -> Document:
    """Across the z axis, from 0 down to -thickness."""
    shape = {
        "type": "box",
        "minimum": [-half_edge, -half_edge, -thickness],
        "maximum": [half_edge, half_edge, 0.0],
    }
    return {"shape": shape, "interior": {"media": [name]}, **more}


def screen(z: float, half_edge: float, radiance: float) -> Document:
    """A black square across the z axis that shines on both sides."""
    made: Document = {
        "shape": quad([-half_edge, -half_edge, z], [2 * half_edge, 0, 0], [0, 2 * half_edge, 0]),
        "kernel": BLACK,
    }
    return made | ({"luminaire": {"radiance": radiance, "two_sided": True}} if radiance else {})


def along(degrees: float, distance: float, diameter: float = 1e-3) -> Document:
    """A radiance meter above the origin that looks at it, at an angle to the z axis."""
    angle = np.radians(degrees)
    return {
        "type": "radiance_meter",
        "position": [float(distance * np.sin(angle)), 0.0, float(distance * np.cos(angle))],
        "look_at": [0.0, 0.0, 0.0],
        "up": [0, 1, 0],
        "diameter": diameter,
        "cone_degrees": 0.01,
    }


def from_above(z: float) -> Document:
    """A small film just above the slab, that faces it."""
    return film([0, 0, z], [0, 0, -1], 1e-3)


def lit_slab(fog: Document, thickness: float, sensor: Document, *, below: bool, **more: Any) -> Document:
    """A slab with even light from below or from above, and darkness on the other side.

    Even light is an environment; a black square covers the dark side.
    """
    half_edge = max(WIDTH, 10.0 * thickness)
    # So wide that no light comes in between.
    dark = screen(3.0 if below else -thickness - 1.0, 1e6, 0.0)
    document = measured_scene(sensor, [slab(thickness, half_edge, **more), dark])
    return document | {"media": {"fog": fog}, "environment": {"radiance": 1.0}}


def sun(zenith: float, azimuth: float = 0.0, **light: Any) -> Document:
    """A small disc at infinity; degrees, azimuth from x towards y. Irradiance 1 unless `light` says other."""
    zenith, azimuth = np.radians(zenith), np.radians(azimuth)
    across = float(np.sin(zenith))
    direction = [across * float(np.cos(azimuth)), across * float(np.sin(azimuth)), float(np.cos(zenith))]
    return {"direction": direction, "angular_diameter_degrees": 0.01, **(light or {"irradiance": 1.0})}


def read(document: Document, folder: Path, samples: int, edge: int = 8, channel: str = "grey") -> Reading:
    """Mean of edge x edge pixels that all measure the same."""
    folder.mkdir(parents=True, exist_ok=True)
    return Measurement(document, folder, edge, edge).by_pixels(samples, channel)
