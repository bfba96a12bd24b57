"""Runs inside Blender's Python: installs the zip, and renders with a service that the add-on starts."""

import os
import sys
from pathlib import Path

folder, program = Path(sys.argv[1]), sys.argv[2]
os.environ["BLENDER_USER_RESOURCES"] = str(folder / "blender")
os.environ["NOCTURNE_PROGRAM"], os.environ["NOCTURNE_DATA"] = program, str(folder / "data")

import bpy  # noqa: E402 - after the folders


def main() -> None:
    """Installs, switches on, renders."""
    import addon_utils  # found once Blender is there

    addon_utils.enable("bl_pkg")
    [archive] = (folder / "dist").glob("*.zip")
    bpy.ops.extensions.package_install_files(
        filepath=str(archive), repo="user_default", enable_on_install=True, overwrite=True
    )
    scene = bpy.context.scene
    scene.render.engine = "NOCTURNE"
    scene.render.resolution_x = scene.render.resolution_y = 48
    scene.render.resolution_percentage = 100
    scene.nocturne.url, scene.nocturne.samples = "http://127.0.0.1:" + sys.argv[3], 4
    scene.render.filepath = str(folder / "image.png")
    bpy.ops.render.render(write_still=True)


main()
