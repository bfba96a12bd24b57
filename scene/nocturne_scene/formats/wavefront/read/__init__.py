"""Wavefront OBJ with its MTL files: geometry that people have, in metres and with y up."""

from nocturne_scene.formats.wavefront.read.scene import import_obj

__all__ = ["import_obj"]
