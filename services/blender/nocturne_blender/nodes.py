"""Values of sockets: numbers, colours, or textures of the document."""

import math
from dataclasses import dataclass
from typing import Any

from . import light
from .findings import Findings
from .images import Images

Json = Any

# Node groups and reroutes that are looked through, one after the other.
_MAX_STEPS = 32


@dataclass(frozen=True)
class Reader:
    """Reads sockets of one material, lamp or world."""

    name: str
    images: Images
    findings: Findings

    def lost(self, what: str) -> None:
        """Something is not supported."""
        self.findings.lost(self.name, what)

    def number(self, socket: Any) -> float:
        """A number that is the same everywhere."""
        node = source(socket)
        if node is None:
            return float(socket.default_value)
        if node.bl_idname == "ShaderNodeValue":
            return float(node.outputs[0].default_value)
        self.lost(
            f"no support for what is linked to {socket.name!r}; {float(socket.default_value):.3g} is taken"
        )
        return float(socket.default_value)

    def colour(self, socket: Any) -> list[float]:
        """A colour that is the same everywhere, of any size."""
        node = source(socket)
        found = None if node is None else self._constant(node)
        if node is not None and found is None:
            self.lost(f"no support for what is linked to {socket.name!r}; its own colour is taken")
        return [float(value) for value in (found or socket.default_value)[:3]]

    def scalar(self, socket: Any) -> Json:
        """A number in [0, 1], or a ScalarTexture."""
        node = source(socket)
        use = None if node is None else self._use(node, colour=False, alpha=_of_alpha(socket))
        return min(1.0, max(0.0, self.number(socket))) if use is None else use

    def reflectance(self, socket: Any) -> Json:
        """A spectrum of a colour in [0, 1], or a ColourTexture."""
        use = self.texture(socket)
        return light.reflectance(self.colour(socket)) if use is None else use

    def texture(self, socket: Any) -> Json | None:
        """A ColourTexture, where an image is linked."""
        node = source(socket)
        return None if node is None else self._use(node, colour=True)

    def _constant(self, node: Any) -> list[float] | None:
        if node.bl_idname == "ShaderNodeRGB":
            return list(node.outputs[0].default_value)
        if node.bl_idname == "ShaderNodeValue":
            return [node.outputs[0].default_value] * 3
        return None

    def _use(self, node: Any, *, colour: bool, alpha: bool = False) -> Json | None:
        if node.bl_idname != "ShaderNodeTexImage":
            return None
        texture = self.images.texture(node, colour=colour, alpha=alpha)
        if texture is None:
            return None
        return {"texture": texture} | self._mapping(node)

    def _mapping(self, node: Any) -> Json:
        """Scale and offset of a Mapping node; the image on the active coordinates otherwise."""
        mapping = source(node.inputs["Vector"])
        if mapping is None or mapping.bl_idname in ("ShaderNodeUVMap", "ShaderNodeTexCoord"):
            return {}
        if mapping.bl_idname != "ShaderNodeMapping":
            self.lost("no support for a texture's coordinates; those of the mesh are taken")
            return {}
        if mapping.vector_type not in ("POINT", "TEXTURE") or any(
            abs(angle) > 1e-6 for angle in mapping.inputs["Rotation"].default_value
        ):
            self.lost("no support for a turned texture; taken as not turned")
        scale = [float(value) for value in mapping.inputs["Scale"].default_value[:2]]
        shift = [float(value) for value in mapping.inputs["Location"].default_value[:2]]
        if mapping.vector_type == "TEXTURE":
            scale = [1 / value if value else 1.0 for value in scale]
            shift = [-value * factor for value, factor in zip(shift, scale, strict=True)]
        if not all(math.isfinite(value) and value != 0 for value in scale):
            return {}
        return {"scale": scale, "offset": shift}


def source(socket: Any) -> Any:
    """The node that a socket is linked to, reroutes and groups looked through; None where it has none."""
    link = _link(socket)
    for _ in range(_MAX_STEPS):
        if link is None:
            return None
        node = link.from_node
        if node.bl_idname == "NodeReroute" or node.mute:
            link = _link(node.inputs[0]) if node.inputs else None
        else:
            return node
    return None


def _of_alpha(socket: Any) -> bool:
    """Whether a socket is linked to the opacity of an image."""
    return bool(socket.links[0].from_socket.identifier == "Alpha")


def _link(socket: Any) -> Any:
    return socket.links[0] if socket.is_linked and not socket.links[0].is_muted else None


def output(tree: Any, kind: str) -> Any:
    """The active output node of a tree."""
    found = [node for node in tree.nodes if node.bl_idname == kind]
    active = [node for node in found if node.is_active_output and node.target in ("ALL", "CYCLES")]
    return next(iter(active or found), None)
