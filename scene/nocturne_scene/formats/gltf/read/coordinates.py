"""Texture coordinates: one set for a mesh here, a set and an affine map for each texture in glTF."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from nocturne_scene.formats.gltf.read.container import Container, Json, floats, number, value
from nocturne_scene.formats.reading.transforms import Matrix

_STRAIGHT = 1e-6


@dataclass(frozen=True)
class Frame:
    """The coordinates that a mesh gets: a set of the file's, and what maps it."""

    number: int
    matrix: Matrix
    """3 x 3, of (u, v, 1) with v down the picture."""


def frame_of(container: Container, material: Json, place: str) -> Frame:
    """The frame in which as many of a material's textures as can be are only scaled and shifted."""
    found = [
        (set_of(container, each, place), map_of(container, each, place)) for each in _references(material)
    ]
    numbers = [number for number, _ in found]
    used = max(set(numbers), key=numbers.count, default=0)
    turned = [matrix for number, matrix in found if number == used and not is_straight(matrix)]
    return Frame(used, turned[0] if turned else np.eye(3))


def set_of(container: Container, reference: Json, place: str) -> int:
    """The number of the set of coordinates that a texture is looked up with."""
    transform = value(value(reference, "extensions", {}), "KHR_texture_transform", {})
    entry = transform if "texCoord" in transform else reference
    return container.count(entry, "texCoord", place, 0) if isinstance(entry, dict) else 0


def map_of(container: Container, reference: Json, place: str) -> Matrix:
    """The map of KHR_texture_transform: scaled, turned counter-clockwise as seen, shifted."""
    transform = value(value(reference, "extensions", {}), "KHR_texture_transform", {})
    angle = number(container, transform, "rotation", 0.0, place)
    scale = floats(container, transform, "scale", [1.0, 1.0], place)
    cosine, sine = math.cos(angle), math.sin(angle)
    # v points down, so that this turns as the specification's words and Khronos' viewer do.
    found = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]]) @ np.diag([*scale, 1.0])
    found[:2, 2] = floats(container, transform, "offset", [0.0, 0.0], place)
    return found


def is_straight(matrix: Matrix) -> bool:
    """Whether a map only scales and shifts."""
    across = max(abs(float(matrix[0, 1])), abs(float(matrix[1, 0])))
    return across <= _STRAIGHT * max(1.0, float(np.abs(matrix).max()))


def relative_map(container: Container, reference: Json, frame: Frame, place: str) -> Matrix | None:
    """What maps a mesh's coordinates to a texture's; None where no scale and shift does."""
    if set_of(container, reference, place) != frame.number or not abs(np.linalg.det(frame.matrix)) > 0:
        return None
    found = np.asarray(map_of(container, reference, place) @ np.linalg.inv(frame.matrix))
    return found if is_straight(found) else None


def _references(material: Any, depth: int = 0) -> list[Json]:
    """All texture references of a material and its extensions."""
    if not isinstance(material, dict) or depth > 4:
        return []
    found = [each for key, each in material.items() if key.endswith("Texture") and isinstance(each, dict)]
    # Occlusion is left out.
    found = [each for each in found if each is not material.get("occlusionTexture")]
    return found + [
        inner
        for key, each in material.items()
        if not key.endswith("Texture")
        for inner in _references(each, depth + 1)
    ]
