"""A glTF file of one plate, a lamp and a camera."""

import base64
import json

import numpy as np

CORNERS = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], dtype="<f4").tobytes()
INDICES = np.array([0, 1, 2, 0, 2, 3], dtype="<u2").tobytes()
# From its -z to (0, -1, 0), and from there to the line of sight.
DOWN = [-(0.5**0.5), 0, 0, 0.5**0.5]
AHEAD = [-np.sin(np.arctan2(1, 3) / 2), 0, 0, np.cos(np.arctan2(1, 3) / 2)]

# Without a specular part: of refractive index 1.
MATT: dict[str, object] = {
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.5, 0.5, 1],
        "metallicFactor": 0,
        "roughnessFactor": 1,
    },
    "extensions": {"KHR_materials_ior": {"ior": 1}},
}


def gltf(light: dict[str, object], material: dict[str, object] = MATT) -> str:
    """A plate below a lamp at a height of 2 that points down; seen from (0, 1, 3), half a degree wide."""
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [light]}},
            "scene": 0,
            "scenes": [{"nodes": [0, 1, 2]}],
            "nodes": [
                {"mesh": 0},
                {"camera": 0, "translation": [0, 1, 3], "rotation": AHEAD},
                {
                    "translation": [0, 2, 0],
                    "rotation": DOWN,
                    "extensions": {"KHR_lights_punctual": {"light": 0}},
                },
            ],
            "cameras": [{"type": "perspective", "perspective": {"yfov": np.radians(0.5), "znear": 0.1}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
            "materials": [material],
            "buffers": [
                {
                    "byteLength": len(CORNERS + INDICES),
                    "uri": "data:application/octet-stream;base64,"
                    + base64.b64encode(CORNERS + INDICES).decode(),
                }
            ],
            "bufferViews": [
                {"buffer": 0, "byteLength": len(CORNERS)},
                {"buffer": 0, "byteOffset": len(CORNERS), "byteLength": len(INDICES)},
            ],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            ],
        }
    )
