"""Nocturne as a render engine of Blender.

Nothing is imported before Blender switches the add-on on, so that the parts that need no Blender can be used
without it.
"""


def register() -> None:
    """Called by Blender when the add-on is switched on."""
    from . import engine, panels, settings

    settings.register()
    engine.register()
    panels.register()


def unregister() -> None:
    """Called by Blender when it is switched off."""
    from . import engine, local_service, panels, settings

    panels.unregister()
    engine.unregister()
    settings.unregister()
    local_service.stop_all()
