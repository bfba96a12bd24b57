"""Light for models that have none: an overcast sky, a studio, or a picture of all directions.

In the first two a white surface that faces the light has 1 cd/m2, as glTF's viewers show models: an emissive
factor of 1 is 1 cd/m2 there, too.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.textures.environment_maps import read_whole
from nocturne_scene.textures.pictures import UnusableImageError

NAMES = ("sky", "studio")

Pixels = NDArray[np.float64]

_ROWS = 128
# Of the ground below the sky: dry soil and grass, CIE 110-1994.
_GROUND = 0.2

# Soft boxes of the studio: degrees to the right of where the camera looks from and up, half their width and
# height, and brightness. The key light is four times the fill, as portraits are lit; the third is behind.
_BOXES = ((-45.0, 40.0, 25.0, 20.0, 4.0), (50.0, 20.0, 25.0, 25.0, 1.0), (170.0, 50.0, 30.0, 12.0, 2.0))
_ROOM = 0.05


def light_up(writer: SceneWriter, findings: Findings, wanted: str | None) -> None:
    """Give a scene that was imported the light that is wanted, or the sky where it has none at all.

    Raises InputError where `wanted` is neither a name nor a picture.
    """
    document = writer.document
    if wanted is None and _has_light(document):
        return
    if "environment" in document:
        findings.note("", f"the file has a sky of its own; --light {wanted} is left out")
        return
    name = wanted or "sky"
    if name in NAMES:
        pixels = overcast_sky() if name == "sky" else studio()
        found = {"asset": writer.picture(name, pixels)}
    else:
        found = {"asset": _copied(writer, Path(name))}
    document["environment"] = found | _frame(document.get("sensor", {}))
    if wanted is None:
        findings.note(
            "",
            "the file has no light: an overcast sky lights it, a white surface that faces up having 1 cd/m2; "
            "choose another with --light",
        )


def overcast_sky() -> Pixels:
    """The CIE's overcast sky over grey ground: at height h (1 + 2 sin h) / 3 of its zenith.

    P. Moon and D. Spencer, Illuminating Engineering 37, 1942. A zenith of luminance L gives 7 pi / 9 L,
    here pi lx.
    """
    # The mean of sin h over a row, by height.
    edges = np.cos(np.pi * np.arange(_ROWS + 1) / _ROWS)
    height = (edges[:-1] + edges[1:]) / 2
    rows = np.where(height > 0, (9 / 7) * (1 + 2 * height) / 3, _GROUND)
    return np.broadcast_to(rows[:, None, None], (_ROWS, 2 * _ROWS, 3)).copy()


def studio() -> Pixels:
    """Three soft boxes in a dark room; a surface that faces the camera gets pi lx.

    The picture's middle is behind the camera.
    """
    rows = 4 * _ROWS
    up = 90 - (np.arange(rows) + 0.5) * 180 / rows
    right = (np.arange(2 * rows) + 0.5) * 180 / rows - 180
    picture = np.full((rows, 2 * rows), _ROOM)
    for azimuth, height, wide, high, bright in _BOXES:
        across = np.abs((right - azimuth + 180) % 360 - 180)[None, :] < wide
        picture[(np.abs(up - height)[:, None] < high) & across] = bright
    # Irradiance of what faces the middle: the cosine to it over the solid angle of each pixel.
    cosine = np.cos(np.radians(up))[:, None] * np.cos(np.radians(right))[None, :]
    angle = np.cos(np.radians(up))[:, None] * math.radians(180 / rows) ** 2
    picture *= math.pi / np.sum(picture * np.maximum(cosine, 0) * angle)
    return np.repeat(picture[..., None], 3, axis=2)


def _has_light(document: dict[str, Any]) -> bool:
    surfaces = [
        *document.get("surfaces", ()),
        *(each for group in document.get("groups", {}).values() for each in group),
    ]
    glowing = any("temperature" in medium for medium in document.get("media", {}).values())
    return (
        glowing
        or any(document.get(kind) for kind in ("environment", "distant", "atmosphere"))
        or any("luminaire" in surface for surface in surfaces)
    )


def _copied(writer: SceneWriter, file: Path) -> str:
    if not file.is_file():
        raise InputError.at("--light", f'expected {", ".join(NAMES)} or a picture; there is no file "{file}"')
    try:
        read_whole(file)
    except UnusableImageError as error:
        raise InputError.at(str(file), str(error)) from None
    return writer.copy(file)


def _frame(sensor: Json) -> Json:
    """The picture's middle is behind the camera, turned about the camera's upright."""
    up = np.array(sensor.get("up", (0.0, 1.0, 0.0)), dtype=np.float64)
    # Cameras are tilted, the world is not: its upright is the axis that theirs is nearest to.
    axis = int(np.argmax(np.abs(up)))
    upright = np.sign(up[axis]) * np.eye(3)[axis]
    position, ahead = (np.array(sensor.get(key, default), dtype=np.float64) for key, default in _LOOKING)
    behind = position - ahead
    behind -= (behind @ upright) * upright
    if not np.linalg.norm(behind) > 1e-6 * max(1.0, float(np.linalg.norm(position - ahead))):
        behind = np.eye(3)[(axis + 1) % 3]
    return {"up": upright.tolist(), "forward": (behind / np.linalg.norm(behind)).tolist()}


_LOOKING = (("position", (0.0, 0.0, 1.0)), ("look_at", (0.0, 0.0, 0.0)))
