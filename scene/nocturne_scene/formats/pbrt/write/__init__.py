"""Scenes for pbrt-v4: a text file with meshes and pictures.

Its conventions are those that the importer undoes (`importing.pbrt`): light is in cd/m2, the camera looks
along z with x to the right, a roughness is alpha where it is not remapped.
"""

from nocturne_scene.formats.pbrt.write.scene import export_pbrt

__all__ = ["export_pbrt"]
