"""Panels of our settings, and Blender's own panels that fit."""

from collections.abc import Iterator
from typing import Any

import bpy

ENGINE = "NOCTURNE"

# Panels of other engines whose settings we read.
_ALSO = (
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_MATERIAL_PT_volume",
    "EEVEE_WORLD_PT_surface",
    "DATA_PT_EEVEE_light",
)
# Blender features that are not supported.
_NOT = ("RENDER_PT_freestyle", "RENDER_PT_simplify", "VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes")


class _RenderPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = frozenset((ENGINE,))

    @classmethod
    def poll(cls, context: Any) -> bool:
        """Where the engine is chosen."""
        return bool(context.engine == ENGINE)


class RENDER_PT_nocturne(_RenderPanel, bpy.types.Panel):
    """What a render asks of the service."""

    bl_label = "Nocturne"
    bl_context = "render"

    def draw(self, context: Any) -> None:
        """Shows the scene's settings."""
        layout, settings = self.layout, context.scene.nocturne
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("url", "start_here", "samples", "error", "seconds", "until"):
            layout.prop(settings, name)


class DATA_PT_nocturne_light(_RenderPanel, bpy.types.Panel):
    """A lamp's photometry and spectrum."""

    bl_label = "Photometry"
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        """For lamps."""
        return bool(context.engine == ENGINE and context.light is not None)

    def draw(self, context: Any) -> None:
        """Shows the lamp's settings."""
        layout, settings = self.layout, context.light.nocturne
        layout.use_property_split = True
        layout.prop(settings, "unit")
        if settings.unit == "LUMENS":
            layout.prop(settings, "lumens")
        layout.prop(settings, "spectrum")
        if settings.spectrum == "ILLUMINANT":
            layout.prop(settings, "illuminant")


_CLASSES = (RENDER_PT_nocturne, DATA_PT_nocturne_light)


def _shared() -> Iterator[Any]:
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        name = panel.__name__
        if name in _ALSO or ("BLENDER_RENDER" in engines and name not in _NOT):
            yield panel


def register() -> None:
    """Shows the panels."""
    for each in _CLASSES:
        bpy.utils.register_class(each)
    for panel in _shared():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    """Takes them away."""
    for panel in _shared():
        panel.COMPAT_ENGINES.discard(ENGINE)
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
