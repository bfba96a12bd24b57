"""Textures whose texels are far smaller than any pixel of the film sees them."""

import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.node import Node
from nocturne_scene.document.problems import path
from nocturne_scene.document.sensors import Orthographic, Pinhole, ThinLens
from nocturne_scene.document.shapes import MediumBox, Sphere
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.document.textures import TextureUse
from nocturne_scene.errors import NocturneError
from nocturne_scene.film import Film
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.textures.pictures import UnusableImageError, opened

_TOO_FINE = 8.0
"""Texels along a pixel's edge: the three finest levels of the texture are never looked at."""


def fine_textures(workspace: Workspace, shapes: Shapes, film: Film) -> Iterator[str]:
    """Sentences with their places; of surfaces that do not move, seen by a lens or by parallel rays."""
    document = workspace.document
    sensor = document.sensor
    if sensor.motion is not None or not isinstance(sensor, Pinhole | ThinLens | Orthographic):
        return
    # To open a picture can take a tenth of a second, and hundreds of surfaces may show the same.
    sizes: dict[str, tuple[int, int]] = {}
    for index, surface in enumerate(document.surfaces):
        uses = list(
            _uses(document.kernels.get(surface.kernel) if isinstance(surface.kernel, str) else surface.kernel)
        )
        # Maps of normals and heights are looked up at their finest level at any distance.
        uses += _uses(surface.luminaire)
        if not uses or surface.motion is not None:
            continue
        pixel = _pixel(shapes, surface, sensor, film.height)
        for use in uses:
            texels = _texels(workspace, use, sizes)
            texel = _texel(shapes, surface, use, texels) if texels else 0.0
            if texel > 0.0 and pixel / texel > _TOO_FINE:
                yield (
                    f"{path(('surfaces', index))}: its texture of {texels[0]} x {texels[1]} texels has "
                    f"{pixel / texel:.0f} of them along a pixel's edge where it is nearest; a smaller "
                    "picture gives the same image"
                )
                break


def _uses(value: Any) -> Iterator[TextureUse]:
    """All textures that a part of the document looks up."""
    if isinstance(value, TextureUse):
        yield value
    elif isinstance(value, Node):
        for name in type(value).model_fields:
            yield from _uses(getattr(value, name))
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _uses(each)


def _pixel(shapes: Shapes, surface: Surface, sensor: Pinhole | ThinLens | Orthographic, rows: int) -> float:
    """Metres that a pixel sees where the surface is nearest; 0 where that is not known."""
    if isinstance(sensor, Orthographic):
        return sensor.height / rows
    if isinstance(surface.shape, Sphere | MediumBox):
        return 0.0
    try:
        extent = shapes.extent(surface.shape, placement_of(surface))
    except (Unusable, UnusableMeshError):
        return 0.0
    if extent is None:
        return 0.0
    position = np.array(sensor.position)
    nearest = np.clip(position, *extent)
    angle = math.radians(sensor.vertical_field_of_view_degrees)
    return float(np.linalg.norm(nearest - position)) * 2.0 * math.tan(0.5 * angle) / rows


def _texels(workspace: Workspace, use: TextureUse, sizes: dict[str, tuple[int, int]]) -> tuple[int, int]:
    """Columns and rows of the picture; none where it can't be read. `sizes`: of those that were opened."""
    texture = workspace.document.textures[use.texture] if isinstance(use.texture, str) else use.texture
    if texture.asset not in sizes:
        sizes[texture.asset] = 0, 0
        with suppress(Unusable, UnusableImageError, NocturneError):
            sizes[texture.asset] = _size(workspace.blobs.path(workspace.asset(texture.asset).hex()))
    return sizes[texture.asset]


def _size(picture: Path) -> tuple[int, int]:
    with opened(picture) as file:
        spec = file.spec()
        return spec.width, spec.height


def _texel(shapes: Shapes, surface: Surface, use: TextureUse, texels: tuple[int, int]) -> float:
    """Metres of a texel's edge, on the mean over the surface; 0 where that is not known."""
    try:
        area = shapes.area_of_texture(surface.shape)
    except (Unusable, UnusableMeshError):
        return 0.0
    repeats = abs(use.scale[0] * use.scale[1]) * texels[0] * texels[1]
    return surface.scale * math.sqrt(area / repeats) if repeats > 0.0 else 0.0
