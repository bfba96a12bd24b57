"""Runs inside Blender's Python: two frames of the factory scene, in which the cube moves."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parents[2] / "services" / "blender"))

import nocturne_blender

nocturne_blender.register()
scene, cube = bpy.context.scene, bpy.data.objects["Cube"]
scene.render.engine = "NOCTURNE"
scene.render.resolution_x = scene.render.resolution_y = 48
scene.render.resolution_percentage = 100
scene.nocturne.url, scene.nocturne.samples = sys.argv[1], 4
scene.frame_start, scene.frame_end = 1, 2
for frame in (1, 2):
    cube.location.x = frame - 1
    cube.keyframe_insert("location", frame=frame)
scene.render.filepath = sys.argv[2] + "/"
bpy.ops.render.render(animation=True)
