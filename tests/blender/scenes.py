"""Scenes for Blender, made by its own Python: run inside Blender only."""

import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector


def factory() -> None:
    """Cube, lamp and camera, as Blender starts; the cube's shader is diffuse."""
    _material(bpy.data.objects["Cube"], lambda nodes: _diffuse(nodes, (0.8, 0.8, 0.8, 1)))


def plastic() -> None:
    """The same with the cube's own Principled BSDF."""


def aside() -> None:
    """The factory's scene by an orthographic camera that is shifted."""
    factory()
    camera = bpy.context.scene.camera.data
    camera.type, camera.ortho_scale = "ORTHO", 7
    camera.shift_x, camera.shift_y = 0.2, -0.1


def room() -> None:
    """A room of diffuse walls, one with a texture, under area lamps of three shapes."""
    _clear()
    _world(0.0)
    _camera((0, -3.4, 1.5), (0, 0, 1.3), 60)
    for corner, along, across, colour in (
        ((-2, -4, 0), (4, 0, 0), (0, 6, 0), (0.7, 0.7, 0.7, 1)),
        ((-2, -4, 3), (0, 6, 0), (4, 0, 0), (0.8, 0.8, 0.8, 1)),
        ((-2, -4, 0), (0, 6, 0), (0, 0, 3), (0.6, 0.1, 0.08, 1)),
        ((2, -4, 0), (0, 0, 3), (0, 6, 0), (0.1, 0.4, 0.12, 1)),
        ((2, -4, 0), (-4, 0, 0), (0, 0, 3), (0.7, 0.7, 0.7, 1)),
    ):
        _wall(corner, along, across, lambda nodes, colour=colour: _diffuse(nodes, colour))
    _wall((-2, 2, 0), (4, 0, 0), (0, 0, 3), _checked)
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0.6, 0.4, 0.4), rotation=(0, 0, 0.5))
    box = bpy.context.object
    _material(box, lambda nodes: _diffuse(nodes, (0.3, 0.35, 0.7, 1)))
    twin = box.copy()  # shares its mesh: an instance
    twin.location = (-0.9, 0.9, 0.2)
    twin.scale = (0.5, 0.5, 0.5)
    bpy.context.collection.objects.link(twin)
    _lamp("AREA", (0, 0, 2.95), energy=60, shape="RECTANGLE", size=1.0, size_y=0.5)
    _lamp("AREA", (-1.2, 1, 2.9), energy=20, shape="DISK", size=0.4, color=(1, 0.6, 0.3))
    _lamp("AREA", (1.2, 1, 2.9), energy=20, shape="ELLIPSE", size=0.6, size_y=0.3, color=(0.4, 0.6, 1))
    spot = _lamp(
        "SPOT", (0, -2, 2.8), energy=150, spot_size=math.radians(50), spot_blend=0.4, shadow_soft_size=0.05
    )
    spot.rotation_euler = (0.5, 0, 0)


def spheres() -> None:
    """Balls of glass, metal and rough white on a diffuse floor, under an HDR picture of a sky, and a sun."""
    _clear()
    _camera((0, -5, 2.2), (0, 0, 0.6), 45)
    _wall((-6, -6, 0), (12, 0, 0), (0, 12, 0), lambda nodes: _diffuse(nodes, (0.5, 0.5, 0.5, 1)))
    _ball((-1.4, 0, 0.6), lambda nodes: _glass(nodes))
    _ball((0, 0.4, 0.6), lambda nodes: _metal(nodes, (0.95, 0.64, 0.35, 1), 0.2))
    _ball((1.4, 0, 0.6), lambda nodes: _diffuse(nodes, (0.8, 0.8, 0.8, 1)))
    nodes = _world(1.0)
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = _sky()
    mapping, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = (0, 0, math.radians(40))
    links = bpy.context.scene.world.node_tree.links
    links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])
    sun = _lamp("SUN", (0, 0, 3), energy=1.0, angle=math.radians(5))
    sun.rotation_euler = (0.6, 0.4, 0)


def crowd() -> None:
    """1,225 boxes, turned and scaled, on the vertices of a floor."""
    _clear()
    _camera((0, -7, 3.5), (0, 0, 0), 45)
    _world(1.0)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=34, y_subdivisions=34, size=7)
    floor = bpy.context.object
    _material(floor, lambda nodes: _diffuse(nodes, (0.2, 0.3, 0.6, 1)))
    bpy.ops.mesh.primitive_cube_add(size=0.1, rotation=(0.3, 0.2, 0.5), scale=(1.2, 1.2, 1.2))
    box = bpy.context.object
    _material(box, lambda nodes: _diffuse(nodes, (0.7, 0.4, 0.2, 1)))
    box.parent, floor.instance_type = floor, "VERTS"


def cloud() -> None:
    """Even fog from an OpenVDB file, twice as large as there, and hair, on a floor under a white sky."""
    _clear()
    _camera((0, -6, 2.0), (0, 0, 0.9), 45)
    _world(1.0)
    _wall((-6, -6, 0), (12, 0, 0), (0, 12, 0), lambda nodes: _diffuse(nodes, (0.5, 0.5, 0.5, 1)))
    _volume((-1.4, 0, 0.2), 2.0, 0.8)
    _hair((1.2, 0, 0))


def moving() -> None:
    """Of three turning boxes one crosses the image, one stands, and one grows; a camera that rises."""
    _clear()
    _world(0.3)
    _camera((0, -7, 1.5), (0, 0, 1), 50)
    _wall((-8, 4, -3), (16, 0, 0), (0, 0, 10), lambda nodes: _diffuse(nodes, (0.1, 0.1, 0.1, 1)))
    _lamp("POINT", (0, -4, 4), energy=600, shadow_soft_size=0.3)
    for x, shift, grows in ((-2, 1.5, 1.0), (0.9, 0.0, 1.0), (2.4, 0.0, 1.6)):
        bpy.ops.mesh.primitive_cube_add(size=0.8, location=(x, 0, 1))
        box = bpy.context.object
        _material(box, lambda nodes: _diffuse(nodes, (0.8, 0.8, 0.8, 1)))
        _key(box, 1, (x - shift, 0, 1), 0.0, 1.0)
        _key(box, 2, (x + shift, 0, 1), 1.2, grows)
    camera = bpy.context.scene.camera
    _key(camera, 1, (0, -7, 1.5), None, 1.0)
    _key(camera, 2, (0, -7, 1.7), None, 1.0)
    scene = bpy.context.scene
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    scene.frame_set(1, subframe=0.5)


def _key(thing: Any, frame: int, place: tuple[float, ...], turn: float | None, scale: float) -> None:
    """At constant speed from one to the next."""
    thing.location, thing.scale = place, (scale,) * 3
    if turn is not None:
        thing.rotation_euler = (0, turn, 0)
    for name in ("location", "rotation_euler", "scale"):
        thing.keyframe_insert(name, frame=frame)
    for strip in thing.animation_data.action.layers[0].strips:
        for curve in strip.channelbag(thing.animation_data.action_slot).fcurves:
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"


SCENES = {
    "moving": moving,
    "factory": factory,
    "plastic": plastic,
    "aside": aside,
    "room": room,
    "spheres": spheres,
    "cloud": cloud,
    "crowd": crowd,
}


def _clear() -> None:
    for each in list(bpy.data.objects):
        bpy.data.objects.remove(each)


def _world(strength: float) -> Any:
    nodes = bpy.context.scene.world.node_tree.nodes
    nodes["Background"].inputs["Strength"].default_value = strength
    return nodes


def _camera(position: tuple[float, ...], target: tuple[float, ...], degrees: float) -> None:
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.angle = math.radians(degrees)
    camera.location = position
    camera.rotation_euler = (Vector(target) - Vector(position)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera


def _lamp(kind: str, position: tuple[float, ...], **fields: Any) -> Any:
    data = bpy.data.lights.new(kind, kind)
    for name, value in fields.items():
        setattr(data, name, value)
    lamp = bpy.data.objects.new(kind, data)
    lamp.location = position
    bpy.context.collection.objects.link(lamp)
    return lamp


def _wall(corner: Any, along: Any, across: Any, shader: Any) -> None:
    start, u, v = Vector(corner), Vector(along), Vector(across)
    mesh = bpy.data.meshes.new("wall")
    mesh.from_pydata([start, start + u, start + u + v, start + v], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new()
    for loop, place in zip(layer.uv, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
        loop.vector = place
    thing = bpy.data.objects.new("wall", mesh)
    bpy.context.collection.objects.link(thing)
    _material(thing, shader)


def _ball(centre: tuple[float, ...], shader: Any) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=centre, segments=96, ring_count=48)
    bpy.ops.object.shade_smooth()
    _material(bpy.context.object, shader)


def _volume(place: tuple[float, ...], scale: float, density: float) -> None:
    bpy.utils.expose_bundled_modules()
    import openvdb  # type: ignore[import-not-found]

    grid = openvdb.FloatGrid()
    grid.name = "density"
    grid.copyFromArray(np.ones((8, 8, 8), np.float32))
    grid.transform = openvdb.createLinearTransform(0.1)
    file = Path(bpy.app.tempdir) / "fog.vdb"
    openvdb.write(str(file), grids=[grid])
    data = bpy.data.volumes.new("fog")
    data.filepath = str(file)
    thing = bpy.data.objects.new("fog", data)
    thing.location, thing.scale = place, (scale,) * 3
    bpy.context.collection.objects.link(thing)
    material = bpy.data.materials.new("fog")
    if material.node_tree is None:  # before Blender 5.0
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    end, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeVolumePrincipled")
    shader.inputs["Density"].default_value = density
    shader.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
    tree.links.new(shader.outputs[0], end.inputs["Volume"])
    data.materials.append(material)


def _hair(place: tuple[float, ...]) -> None:
    """400 straight hairs of two points, 1 m high and 1.2 cm thick."""
    data = bpy.data.hair_curves.new("hair")
    data.add_curves([2] * 400)
    roots = np.random.default_rng(3).uniform(-0.5, 0.5, (400, 3)).astype(np.float32)
    roots[:, 2] = 0
    points = np.stack([roots, roots * 1.3 + np.array([0, 0, 1], np.float32)], axis=1).astype(np.float32)
    data.points.foreach_set("position", points.ravel())
    data.points.foreach_set("radius", np.full(800, 0.006, np.float32))
    thing = bpy.data.objects.new("hair", data)
    thing.location = place
    bpy.context.collection.objects.link(thing)
    _material(thing, lambda nodes: _diffuse(nodes, (0.6, 0.3, 0.1, 1)))


def _material(thing: Any, shader: Any) -> None:
    material = bpy.data.materials.new(thing.name)
    if material.node_tree is None:  # before Blender 5.0
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    end = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader(tree.nodes).outputs[0], end.inputs["Surface"])
    thing.data.materials.clear()
    thing.data.materials.append(material)


def _diffuse(nodes: Any, colour: tuple[float, ...]) -> Any:
    node = nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = colour
    return node


def _checked(nodes: Any) -> Any:
    node, picture = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeTexImage")
    picture.image = _squares()
    picture.interpolation = "Closest"
    node.id_data.links.new(picture.outputs["Color"], node.inputs["Color"])
    return node


def _glass(nodes: Any) -> Any:
    node = nodes.new("ShaderNodeBsdfGlass")
    node.inputs["IOR"].default_value = 1.5
    node.inputs["Roughness"].default_value = 0.0
    return node


def _metal(nodes: Any, colour: tuple[float, ...], rough: float) -> Any:
    node = nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Base Color"].default_value = colour
    node.inputs["Metallic"].default_value = 1.0
    node.inputs["Roughness"].default_value = rough
    return node


def _squares() -> Any:
    """A picture of 8 x 4 squares of any colour, in sRGB."""
    image = bpy.data.images.new("squares", 64, 32)
    colours = np.random.default_rng(7).uniform(0.15, 0.9, (4, 8, 3))
    pixels = np.ones((32, 64, 4), np.float32)
    pixels[..., :3] = np.repeat(np.repeat(colours, 8, axis=0), 8, axis=1)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def _sky() -> Any:
    """A picture of a sky: blue above, brown below, and a bright window on one side."""
    image = bpy.data.images.new("sky", 256, 128, float_buffer=True)
    pixels = np.ones((128, 256, 4), np.float32)
    height = np.linspace(-1, 1, 128)[:, None, None]
    pixels[..., :3] = np.where(height > 0, (0.3, 0.5, 0.9), (0.2, 0.15, 0.1)) * (0.5 + 0.5 * np.abs(height))
    pixels[80:100, 40:70, :3] = (12, 11, 9)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image
