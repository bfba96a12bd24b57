"""Scenes for Mitsuba 3: an XML file with meshes and pictures.

Its conventions are those that the importer undoes (`importing.mitsuba`): what reflects is black from behind
unless it is twosided, a texture's v goes down the picture, its film divides by `units.CANDELAS_PER_UNIT`.
"""

from nocturne_scene.formats.mitsuba.write.scene import export_mitsuba

__all__ = ["export_mitsuba"]
