"""Runs inside Blender's Python: a render of far too many samples, cancelled after the first tiles."""

import sys
from pathlib import Path
from typing import Any

import bpy

sys.path.insert(0, str(Path(__file__).parents[2] / "services" / "blender"))

import nocturne_blender

nocturne_blender.register()

from nocturne_blender import engine  # noqa: E402 - after Blender knows it

shown: list[bool] = []
show = engine._show


def _shown(*words: Any) -> None:
    shown.append(True)
    show(*words)


def _stop_if_asked(_: Any) -> None:
    if shown:
        raise engine.Cancelled


# In the background nobody can press Escape.
vars(engine)["_show"] = _shown
setattr(engine.NocturneEngine, "_stop_if_asked", _stop_if_asked)  # noqa: B010 - mypy takes no other way
scene = bpy.context.scene
scene.render.engine = "NOCTURNE"
scene.render.resolution_x = scene.render.resolution_y = 64
scene.render.resolution_percentage = 100
scene.nocturne.url, scene.nocturne.samples = sys.argv[1], 2**24
bpy.ops.render.render()
