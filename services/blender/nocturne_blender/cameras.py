"""Cameras as sensors."""

import math
from typing import Any

from .findings import Findings

Json = Any


def sensor(scene: Any, camera: Any, findings: Findings) -> Json:
    """The document's sensor for an evaluated camera object."""
    data, matrix = camera.data, camera.matrix_world.normalized()
    position = matrix.translation
    forward, up = -matrix.col[2].to_3d(), matrix.col[1].to_3d()
    _tell_losses(scene, camera, findings)
    pose: Json = {
        "position": list(position),
        "look_at": list(position + forward),
        "up": list(up),
    }
    if data.type == "PANO":
        return {"type": "panorama"} | pose
    corners = data.view_frame(scene=scene)
    height = abs(corners[0].y - corners[2].y)
    if data.type == "ORTHO":
        # A shift moves such a camera to the side.
        middle = (corners[0] + corners[2]) / 2
        aside = matrix.col[0].to_3d() * middle.x + up * middle.y
        at = {"position": list(position + aside), "look_at": list(position + aside + forward)}
        return {"type": "orthographic", "height": height} | pose | at
    degrees = math.degrees(2 * math.atan(height / 2 / abs(corners[0].z)))
    pose |= {"vertical_field_of_view_degrees": degrees}
    if not data.dof.use_dof:
        return {"type": "pinhole"} | pose
    return {"type": "thin_lens"} | pose | _lens(camera, position, forward)


def _lens(camera: Any, position: Any, forward: Any) -> Json:
    dof = camera.data.dof
    distance = dof.focus_distance
    if dof.focus_object is not None:
        distance = (dof.focus_object.matrix_world.translation - position).dot(forward)
    # Diameter in metres: focal length in mm over the f-number.
    lens: Json = {
        "lens_radius": camera.data.lens * 1e-3 / dof.aperture_fstop / 2,
        "focus_distance": max(1e-4, abs(distance)),
    }
    if dof.aperture_blades >= 3:
        lens["aperture"] = {
            "blades": dof.aperture_blades,
            "rotation_degrees": math.degrees(dof.aperture_rotation),
        }
    return lens


def _tell_losses(scene: Any, camera: Any, findings: Findings) -> None:
    data, render = camera.data, scene.render
    if (data.shift_x or data.shift_y) and data.type != "ORTHO":
        findings.lost(camera.name, "no support for a shifted camera; taken as not shifted")
    if data.type == "PANO" and getattr(data, "panorama_type", "EQUIRECTANGULAR") != "EQUIRECTANGULAR":
        findings.lost(camera.name, "of panoramas there is the equirectangular one alone")
    if data.dof.use_dof and data.type == "PERSP" and data.dof.aperture_ratio != 1.0:
        findings.lost(camera.name, "no support for an anamorphic lens; taken as round")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        findings.lost(scene.name, "pixels are square")
    if render.use_border:
        findings.lost(scene.name, "the whole image is rendered, not the region alone")
