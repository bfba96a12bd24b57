"""What scenes of the comparison are made of."""

from collections.abc import Sequence
from typing import Any

from bench.scenes import Document

Kernel = dict[str, Any]
Vec = Sequence[float]


def diffuse(reflectance: float) -> Kernel:
    """Lambert's kernel, grey."""
    return {"type": "lambertian", "reflectance": reflectance}


def textured(picture: str, reflectance: float) -> Kernel:
    """The same, times a picture in the scene's folder."""
    texture = {"asset": picture, "encoding": "linear"}
    return {
        "type": "lambertian",
        "reflectance": {"texture": texture, "spectrum": reflectance, "grey": True},
    }


def quad(corner: Vec, u: Vec, v: Vec, kernel: Kernel) -> Document:
    """A parallelogram; its front is the side of u x v."""
    shape = {"type": "quad", "corner": [*corner], "edge_u": [*u], "edge_v": [*v]}
    return {"shape": shape, "kernel": kernel}


def box(low: Vec, high: Vec, kernel: Kernel) -> Document:
    """Between two corners."""
    return {"shape": {"type": "box", "minimum": [*low], "maximum": [*high]}, "kernel": kernel}
