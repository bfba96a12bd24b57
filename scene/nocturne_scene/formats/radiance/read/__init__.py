"""Radiance scene descriptions (`.rad`): primitives as G. Ward Larson and R. Shakespeare, "Rendering with
Radiance" (1998), and the program's reference manual describe them.

Conventions that the functions undo: z is up and y north; radiance is in W/(sr m2) of three channels, of which
179 lm/W make luminance; a light emits from the side that its normal points to.
"""

from nocturne_scene.formats.radiance.read.scene import import_radiance

__all__ = ["import_radiance"]
