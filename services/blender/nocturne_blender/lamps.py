"""Lamps as luminaires on surfaces, and as discs at infinity.

How many watts give how much radiance, as Cycles has it: a point or spot of P W has the intensity P / (4 pi)
in all directions (of its cone), so that its sphere of radius r has the radiance P / (4 pi^2 r^2); an area
lamp has P / (pi A), a sun the irradiance that its strength says.
"""

import math
from typing import Any

from mathutils import Vector

from . import light
from .files import Files, spot_photometry
from .findings import Findings

Json = Any

# Metres: a lamp without a size is a small ball.
_LEAST_RADIUS = 1e-3
# Degrees: what a document takes.
_LEAST_SUN = 0.01
# Of an ellipse's circle.
_SEGMENTS = 96


class Lamps:
    """Puts lamps into a document."""

    def __init__(self, document: Json, files: Files, findings: Findings) -> None:
        self._document, self._files, self._findings = document, files, findings

    def add(self, lamp: Any, matrix: Any, motion: Json) -> None:
        """An evaluated lamp object, where it stands; `motion`: fields of its surface."""
        data = lamp.data
        kind = {"POINT": self._ball, "SPOT": self._ball, "AREA": self._area, "SUN": self._sun}[data.type]
        if data.node_tree is not None and getattr(data, "use_nodes", True):
            self._findings.lost(lamp.name, "no support for a lamp's nodes; its colour and power are taken")
        before = len(self._document["surfaces"])
        kind(lamp, matrix)
        for surface in self._document["surfaces"][before:]:
            surface.update(motion)
        if motion and data.type in ("SPOT", "SUN"):
            self._findings.lost(lamp.name, "shines where it does at the frame while the shutter is open")

    def _surface(self, lamp: Any, shape: Json, luminaire: Json) -> None:
        if luminaire["radiance"] == 0.0:
            return
        hidden = _hidden_from(lamp)
        self._document["surfaces"].append(
            {"shape": shape, "kernel": {"type": "null"}, "luminaire": luminaire | hidden}
        )

    def _ball(self, lamp: Any, matrix: Any) -> None:
        data = lamp.data
        radius = max(_LEAST_RADIUS, data.shadow_soft_size * _mean_scale(matrix))
        watts = data.energy * (1.0 if data.normalize else 4 * math.pi * radius**2)
        shape = {"type": "sphere", "centre": list(matrix.translation), "radius": radius}
        luminaire = _amount(data, watts / (4 * math.pi**2 * radius**2))
        if data.type == "SPOT":
            luminaire = self._spot(lamp, matrix, luminaire, radius)
        self._surface(lamp, shape, luminaire)

    def _spot(self, lamp: Any, matrix: Any, luminaire: Json, radius: float) -> Json:
        data = lamp.data
        if luminaire["radiance"] == 0.0:
            return luminaire
        lumens = luminaire.pop("lumens", None)
        candela = 1.0 if lumens else luminaire["radiance"]["luminance"] * math.pi * radius**2
        turned = matrix.to_3x3()
        profile = {
            "asset": self._files.add(spot_photometry(data.spot_size, data.spot_blend, candela)),
            "axis": list(-turned.col[2].normalized()),
            "zero": list(turned.col[0].normalized()),
        }
        return luminaire | {"profile": profile | ({"lumens": lumens} if lumens else {})}

    def _area(self, lamp: Any, matrix: Any) -> None:
        data = lamp.data
        wide = data.size
        high = data.size_y if data.shape in ("RECTANGLE", "ELLIPSE") else data.size
        along, across = matrix.col[0].to_3d() * wide, matrix.col[1].to_3d() * high
        is_round = data.shape in ("DISK", "ELLIPSE")
        area = along.cross(across).length * (math.pi / 4 if is_round else 1.0)
        if area == 0.0:
            return
        if data.spread < math.pi - 1e-3:
            self._findings.lost(lamp.name, "no support for an area lamp's spread; it shines to all sides")
        watts = data.energy * (1.0 if data.normalize else area)
        centre = matrix.translation
        # The lamp shines along its -z: along x across would be +z.
        shape = (
            _ellipse(centre, across / 2, along / 2)
            if is_round
            else {
                "type": "quad",
                "corner": list(centre - along / 2 - across / 2),
                "edge_u": list(across),
                "edge_v": list(along),
            }
        )
        self._surface(lamp, shape, _amount(data, watts / (math.pi * area)))

    def _sun(self, lamp: Any, matrix: Any) -> None:
        data = lamp.data
        degrees = max(_LEAST_SUN, math.degrees(data.angle))
        projected = math.pi * math.sin(math.radians(degrees) / 2) ** 2
        amount = _amount(data, data.energy / projected)
        radiance = amount["radiance"]
        if lumens := amount.pop("lumens", None):
            radiance = radiance | {"luminance": lumens / projected}
        if radiance != 0.0:
            self._document["distant"].append(
                {
                    "direction": list(matrix.to_3x3().col[2].normalized()),
                    "angular_diameter_degrees": degrees,
                    "radiance": radiance,
                    **_hidden_from(lamp),
                }
            )


def _amount(data: Any, watts_per_area: float) -> Json:
    """Radiance for a lamp's W m-2 sr-1; with our own settings a spectrum, and lumens."""
    rgb = [part * watts_per_area * 2.0 ** getattr(data, "exposure", 0.0) for part in data.color]
    own = data.nocturne
    warm = getattr(data, "use_temperature", False)
    if warm:
        rgb = [part * tint for part, tint in zip(rgb, data.temperature_color, strict=False)]
    radiance = light.radiance(rgb)
    if own.unit == "LUMENS" and own.lumens == 0.0:
        radiance = 0.0
    if radiance == 0.0:
        return {"radiance": 0.0}
    if own.spectrum == "ILLUMINANT":
        radiance = {"illuminant": own.illuminant, "luminance": radiance["luminance"]}
    elif warm and min(data.color) == max(data.color):
        radiance = {"blackbody": data.temperature, "luminance": radiance["luminance"]}
    return {"radiance": radiance} | ({"lumens": own.lumens} if own.unit == "LUMENS" else {})


def _hidden_from(lamp: Any) -> Json:
    has_size = lamp.data.type in ("AREA", "SUN") or lamp.data.shadow_soft_size > 0
    if not has_size or not lamp.visible_glossy:
        return {"hidden_from": "camera_and_mirrors"}
    return {} if lamp.visible_camera else {"hidden_from": "camera"}


def _mean_scale(matrix: Any) -> float:
    return float(sum(matrix.to_scale())) / 3


def _ellipse(centre: Any, first: Any, second: Any) -> Json:
    """A flat mesh around a centre; its normal is first x second. Of the area of the ellipse."""
    step = 2 * math.pi / _SEGMENTS
    factor = math.sqrt(step / math.sin(step))
    corners = [
        centre + factor * (math.cos(step * k) * first + math.sin(step * k) * second) for k in range(_SEGMENTS)
    ]
    return {
        "type": "mesh",
        "vertices": [list(Vector(centre)), *(list(corner) for corner in corners)],
        "triangles": [[0, k + 1, (k + 1) % _SEGMENTS + 1] for k in range(_SEGMENTS)],
    }
