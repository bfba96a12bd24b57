"""glTF 2.0 and GLB: the core's metallic-roughness materials and some of Khronos' extensions.

Conventions that the functions undo: a texture's v goes down the picture; roughness is the root of alpha;
light is in photometric units, an emissive factor of 1 being 1 cd/m2.
"""

from nocturne_scene.formats.gltf.read.scene import import_gltf

__all__ = ["import_gltf"]
