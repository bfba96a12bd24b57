"""pbrt-v4's text scenes.

A file becomes directives with parameters (`tokens`, `parameters`), directives change a graphics state
(`scene`), and shapes, materials, textures and lights become parts of a scene document, one small function
each. Conventions of pbrt's that the functions undo: its world is left-handed, its image's Y is in cd/m2 with
every light's colour scaled to the luminance of its `scale`, roughness is the square of alpha unless
`remaproughness` is false.
"""

from nocturne_scene.formats.pbrt.read.scene import import_pbrt

__all__ = ["import_pbrt"]
