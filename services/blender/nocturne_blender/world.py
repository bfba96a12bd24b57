"""The world as an environment."""

from typing import Any

from mathutils import Euler, Vector

from . import light
from .findings import Findings
from .images import Images
from .nodes import Reader, output, source

Json = Any


def environment(world: Any, images: Images, findings: Findings) -> Json | None:
    """The document's environment; None where the world is black."""
    if world is None:
        return None
    reader = Reader(world.name, images, findings)
    if world.node_tree is None:
        radiance = light.radiance(list(world.color))
        return None if radiance == 0.0 else {"radiance": radiance}
    end = output(world.node_tree, "ShaderNodeOutputWorld")
    if end is None:
        return None
    if source(end.inputs["Volume"]) is not None:
        reader.lost("no support for a world's volume; left out")
    background = source(end.inputs["Surface"])
    if background is None:
        return None
    if background.bl_idname not in ("ShaderNodeBackground", "ShaderNodeEmission"):
        reader.lost(f"no support for a world of {background.bl_label}; it is black")
        return None
    strength = reader.number(background.inputs["Strength"])
    picture = source(background.inputs["Color"])
    if picture is not None and picture.bl_idname == "ShaderNodeTexEnvironment":
        return _map(picture, strength, reader) if strength > 0 else None
    radiance = light.radiance([strength * part for part in reader.colour(background.inputs["Color"])])
    return None if radiance == 0.0 else {"radiance": radiance}


def _map(node: Any, strength: float, reader: Reader) -> Json | None:
    if node.image is None:
        reader.lost("has no image; it is black")
        return None
    if node.projection != "EQUIRECTANGULAR":
        reader.lost("of projections of a world there is the equirectangular one alone")
    turn = _turn(node, reader)
    # The middle of Blender's pictures is seen along +x; +z is up.
    return {
        "asset": reader.images.sky(node.image),
        "luminance": light.LUMENS_PER_WATT * strength,
        "up": list(turn @ Vector((0, 0, 1))),
        "forward": list(turn @ Vector((1, 0, 0))),
        "pixels": "areas",
    }


def _turn(node: Any, reader: Reader) -> Any:
    """What a Mapping node does to directions, the other way round: from the picture to the world."""
    mapping = source(node.inputs["Vector"])
    if mapping is None or mapping.bl_idname == "ShaderNodeTexCoord":
        return Euler((0, 0, 0)).to_matrix()
    if mapping.bl_idname != "ShaderNodeMapping":
        reader.lost("no support for the coordinates of the world's picture; taken as not turned")
        return Euler((0, 0, 0)).to_matrix()
    if any(abs(part - 1) > 1e-6 for part in mapping.inputs["Scale"].default_value):
        reader.lost("no support for a stretched world; taken as not stretched")
    there = Euler(mapping.inputs["Rotation"].default_value).to_matrix()
    return there if mapping.vector_type == "TEXTURE" else there.inverted()
