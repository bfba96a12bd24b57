"""Runs inside Blender's Python: makes a scene, renders it with an engine, and writes all passes.

python in_blender.py SCENE ENGINE OUTPUT.exr [--url URL] [--samples N] [--picture FILE.png] [--open FROM TO]
"""

import argparse
import math
import sys
from pathlib import Path
from typing import Any

import bpy

sys.path[:0] = [
    str(Path(__file__).parents[2] / "services" / "blender"),
    str(Path(__file__).parent),
]

import nocturne_blender  # noqa: E402 - after its path
import scenes  # type: ignore[import-not-found]  # noqa: E402 - after its path


def main() -> None:
    """Renders one scene."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", choices=sorted(scenes.SCENES))
    parser.add_argument("engine", choices=("CYCLES", "NOCTURNE"))
    parser.add_argument("output", type=Path)
    parser.add_argument("--url", default="")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--size", type=int, nargs=2, default=(128, 96))
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--open", type=float, nargs=2, help="The shutter is, as parts of the scene's time.")
    asked = parser.parse_args()
    nocturne_blender.register()
    scenes.SCENES[asked.scene]()
    scene = bpy.context.scene
    if asked.open:
        _open(scene, *asked.open)
    scene.render.resolution_x, scene.render.resolution_y = asked.size
    scene.render.resolution_percentage = 100
    scene.render.engine = _prepared(scene, asked)
    _set_format(scene, "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER")
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(asked.output)
    bpy.ops.render.render(write_still=True)
    if asked.picture:
        _set_format(scene, "IMAGE", "PNG")
        scene.render.image_settings.color_depth = "8"
        scene.render.image_settings.color_mode = "RGB"
        bpy.data.images["Render Result"].save_render(str(asked.picture))


def _open(scene: Any, first: float, last: float) -> None:
    """Open the shutter for a part of the time that it is open for, the middle of which is the frame."""
    whole = scene.render.motion_blur_shutter
    middle = scene.frame_current + scene.frame_subframe + whole * ((first + last) / 2 - 0.5)
    scene.render.motion_blur_shutter = whole * (last - first)
    scene.frame_set(math.floor(middle), subframe=middle - math.floor(middle))


def _prepared(scene: Any, asked: argparse.Namespace) -> str:
    if asked.engine == "NOCTURNE":
        scene.nocturne.url = asked.url
        scene.nocturne.start_here = False
        scene.nocturne.samples = asked.samples
        return "NOCTURNE"
    import addon_utils

    addon_utils.enable("cycles")
    cycles = scene.cycles
    scene.render.engine = "CYCLES"
    cycles.device = "CPU"
    cycles.samples = asked.samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    # What would change the mean: clamped light, blurred mirrors, few bounces, a wide pixel filter.
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.blur_glossy = 0.0
    for name in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
        setattr(cycles, f"{name}_bounces", 64)
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    return "CYCLES"


def _set_format(scene: Any, media: str, kind: str) -> None:
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # since Blender 5.0
        settings.media_type = media
    settings.file_format = kind


if __name__ == "__main__":
    main()
