"""One quantity, measured by many pixels with independent random numbers; the truth is a radiance of 1.

The standard error comes from how the pixels differ: Sobol points within a pixel are not independent, and
those of different pixels are.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.accuracy.agreement import ROUNDING
from tests.accuracy.tracing import Document, part_of, trace
from tests.system.images import Image

Y_PER_RADIANCE = 683.0 * 106.856895
"""683 lm/W times the integral of the CIE 1931 observer's y-bar, nm: cd/m2 per W m-2 sr-1 nm-1."""

NO_ROULETTE: dict[str, Any] = {"h": 1e6}


@dataclass(frozen=True)
class Estimate:
    """A mean over pixels and its standard error."""

    mean: float
    error: float

    @classmethod
    def of(cls, values: Any) -> "Estimate":
        return cls(float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(np.size(values))))

    def check(self, truth: float, bound: float, what: object = "") -> None:
        """Fails where the mean is more than `bound` standard errors and rounding away from the truth."""
        z = (self.mean - truth) / self.error if self.error > 0 else 0.0
        text = f"{what}: {self.mean:.8g} +- {self.error:.2g}, truth {truth:.8g}, z {z:.2f}"
        assert abs(self.mean - truth) <= bound * self.error + ROUNDING * abs(truth), text


def measure(document: Document, folder: Path, samples: int, edge: int = 8) -> Estimate:
    """Radiance in units of a flat spectrum's 1 W m-2 sr-1 nm-1; all pixels see the same."""
    return Estimate.of(trace(document, folder, edge, part_of(samples)).y / Y_PER_RADIANCE)


def flat(image: Image) -> Any:
    """An image of flat spectra as radiances."""
    return image.y / Y_PER_RADIANCE


def beam(degrees: float, height: float = 1e-3) -> Document:
    """A thin film that looks at the origin at an angle to the z axis, from distance 1."""
    angle = np.radians(degrees)
    position = [0.0, float(np.sin(angle)), float(np.cos(angle))]
    return {
        "type": "orthographic",
        "position": position,
        "look_at": [0, 0, 0],
        "up": [1, 0, 0],
        "height": height,
    }


def level(z: float, half_edge: float, kernel: Any, upwards: bool = True, **more: Any) -> Document:
    """A square across the z axis."""
    edges = [[2 * half_edge, 0, 0], [0, 2 * half_edge, 0]]
    shape = {"type": "quad", "corner": [-half_edge, -half_edge, z]}
    shape |= dict(zip(("edge_u", "edge_v"), edges if upwards else edges[::-1], strict=True))
    return {"shape": shape, "kernel": kernel, **more}


def slab(bottom: float, top: float, half_edge: float, kernel: Any) -> Document:
    """A plate across the z axis."""
    shape = {
        "type": "box",
        "minimum": [-half_edge, -half_edge, bottom],
        "maximum": [half_edge, half_edge, top],
    }
    return {"shape": shape, "kernel": kernel}


def scene(sensor: Document, surfaces: list[Document], sky: float | None = 1.0, **tracing: Any) -> Document:
    """A document with light of radiance 1 from everywhere."""
    document: Document = {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, "tracing": tracing}
    return document | ({} if sky is None else {"environment": {"radiance": sky}})
