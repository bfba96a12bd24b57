"""Surfaces without an effect on light: they are in no image, and only cost rays."""

from nocturne_scene.document.kernels import Mask, NullKernel
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.surfaces import Surface


def met_surfaces(document: SceneDocument) -> list[int]:
    """Return the numbers of those of `$.surfaces` that are compiled.

    The others let all light pass, emit none and bound no media. One of them stays where there would be none:
    a scene has surfaces.
    """
    met = [index for index, surface in enumerate(document.surfaces) if not _is_unseen(surface, document)]
    return met or list(range(len(document.surfaces)))[:1]


def _is_unseen(surface: Surface, document: SceneDocument) -> bool:
    if surface.interior is not None or surface.luminaire is not None:
        return False
    kernel = document.kernels[surface.kernel] if isinstance(surface.kernel, str) else surface.kernel
    # A part that is not there at all can be no boundary either.
    return isinstance(kernel, NullKernel) or (isinstance(kernel, Mask) and kernel.opacity == 0.0)
