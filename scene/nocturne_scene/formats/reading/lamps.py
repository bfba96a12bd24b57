"""Lamps without a size, as small lamps of the same power."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.photometry.ies import write as write_photometry
from nocturne_scene.photometry.intensities import Photometry

Direction = NDArray[np.float64]

# No ray of another renderer meets a lamp without a size, whether it comes from the camera or a mirror.
UNSEEN = "camera_and_mirrors"


def ball(centre: Direction, radius: float, luminaire: Json, name: str) -> Json:
    """A sphere that is seen by nothing but its light."""
    return {
        "name": name,
        "shape": {"type": "sphere", "centre": centre.tolist(), "radius": radius},
        "kernel": {"type": "null"},
        "luminaire": luminaire | {"hidden_from": UNSEEN},
    }


def far(direction: list[float], degrees: float, irradiance: Json) -> Json:
    """A disc at infinity that has the same irradiance, face on; `direction` points at it."""
    return {
        "direction": direction,
        "angular_diameter_degrees": degrees,
        "irradiance": irradiance,
        "hidden_from": UNSEEN,
    }


@dataclass(frozen=True)
class Lamps:
    """Adds lamps to a document, and notes what became of them at the `place` in the file."""

    writer: SceneWriter
    findings: Findings
    options: ImportOptions
    extent: Extent

    def radius(self, position: Direction) -> float:
        """The radius of a lamp that has none."""
        given = self.options.light_radius
        return self.extent.lamp_radius(position) if given is None else given

    def far(self, direction: Direction, irradiance: Json, place: str) -> None:
        """Add light from one direction."""
        degrees = self.options.light_degrees
        self.findings.note(
            place, f"light from one direction became a disc of {degrees:g} degrees and the same irradiance"
        )
        self.writer.add("distant", far(direction.tolist(), degrees, irradiance))

    def point(self, position: Direction, intensity: Json, name: str, place: str) -> None:
        """Add a lamp that has the same intensity in all directions, W sr-1 nm-1."""
        radius = self.radius(position)
        self.findings.note(
            place, f"the point became a sphere of radius {radius:.4g} m and the same intensity"
        )
        radiance = colours.scaled(intensity, 1 / (math.pi * radius**2))
        self.writer.add("surfaces", ball(position, radius, {"radiance": radiance}, name))

    def spot(
        self,
        position: Direction,
        axis: Direction,
        intensity: Json,
        profile: tuple[Direction, Direction],
        name: str,
        place: str,
    ) -> None:
        """Add a lamp whose intensity falls with the angle from `axis`.

        `profile`: degrees from 0 to 180, increasing, and the part of the intensity at each, straight in
        between.
        """
        radius = self.radius(position)
        self.findings.note(
            place, f"the spot became a sphere of radius {radius:.4g} m and the same intensities"
        )
        degrees, part = profile
        candela = colours.luminance_of(intensity) * part
        lamp = Photometry(vertical=degrees, horizontal=np.array([0.0]), candela=candela[None])
        number = len(self.writer.document.get("surfaces", []))
        asset = self.writer.file(f"lamps/{name}-{number}.ies", write_photometry(lamp))
        across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        shape = {"asset": asset, "axis": axis.tolist(), "zero": across.tolist()}
        self.writer.add("surfaces", ball(position, radius, {"radiance": intensity, "profile": shape}, name))
