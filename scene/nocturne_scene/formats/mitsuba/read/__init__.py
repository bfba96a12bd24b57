"""Mitsuba 3's XML scenes.

A file becomes a tree of elements (`elements`), plugins become parts of a scene document, one small function
each, found in the tables of their modules. Conventions of Mitsuba's that the functions undo: a texture's v
goes down the picture, surfaces of most materials are black from behind, an image's Y of 1 is
`units.CANDELAS_PER_UNIT`.
"""

from nocturne_scene.formats.mitsuba.read.scene import import_mitsuba

__all__ = ["import_mitsuba"]
