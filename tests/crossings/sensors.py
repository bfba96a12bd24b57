"""Sensors of every type, with every method of measurement."""

from typing import Any

from tests.accuracy.tracing import Document
from tests.crossings.chance import Point, shortened
from tests.crossings.draft import Draft
from tests.crossings.kernels import wall
from tests.crossings.shapes import motion
from tests.crossings.spectra import coefficient

CAMERA: Point = [0.0, 1.3, 1.3]
_FILMS: list[tuple[Point, Point]] = [
    ([0.0, 0.02, 1.15], [0.0, 1.0, 0.0]),
    ([0.0, 1.2, 1.3], [0.0, 0.2, -1.0]),
    ([0.0, 1.4, 1.0], [0.0, 1.0, 0.3]),
]
"""Centres and normals."""
_FAR_FILMS: list[tuple[Point, Point]] = [
    ([0.2, 4.5, 0.3], [0.0, -1.0, 0.0]),
    ([3.5, 0.4, 0.2], [-1.0, 0.2, 0.0]),
    ([-0.3, -0.8, 2.9], [0.0, 1.0, 0.2]),
]
"""The same outside of the ball around all surfaces, or at its edge: above, at and below the ground."""


def camera(draft: Draft) -> Document:
    """Looks at the object in the middle."""
    chance = draft.chance
    made: Document = {
        "type": chance.pick(
            ["pinhole", "pinhole", "thin_lens", "orthographic", "panorama", "radiance_meter"]
        ),
        "position": chance.near(CAMERA, 0.1),
        "look_at": chance.near([0.0, 0.5, -0.2], 0.15),
    }
    if chance.maybe(0.2):
        made["up"] = [chance.number(-0.5, 0.5), 1.0, 0.1]
    match made["type"]:
        case "pinhole":
            made["vertical_field_of_view_degrees"] = chance.number(30, 70)
        case "thin_lens":
            made["vertical_field_of_view_degrees"] = chance.number(30, 60)
            made |= {"lens_radius": chance.number(0.01, 0.05), "focus_distance": chance.number(0.8, 2.0)}
            if chance.maybe(0.5):
                made["aperture"] = {"blades": chance.whole(3, 8)}
                if chance.maybe(0.5):
                    made["aperture"]["rotation_degrees"] = chance.number(0, 60)
        case "orthographic":
            # Its plane must stay in the medium around the camera.
            made |= {"height": 0.2}
        case "radiance_meter":
            made |= {"diameter": 0.06, "cone_degrees": chance.number(5, 40)}
    read = _reading(draft)
    if not {"light_parts", "colour"} & read.keys() and chance.maybe(0.2):
        read["stokes"] = chance.maybe(0.9)
    return made | read | _moving(draft, made["position"])


def film(draft: Draft, *, far: bool = False) -> Document:
    """On the floor, at a wall or in the air; it keeps clear of bodies, and within the room unless it is far.
    Not small: few photons from luminaires meet it."""
    chance = draft.chance
    position, normal = chance.pick(_FAR_FILMS if far else _FILMS)
    made: Document = {"type": "irradiance_meter", "position": position, "height": chance.number(0.5, 0.8)}
    if chance.maybe(0.3):
        made["look_at"] = shortened([position[axis] + normal[axis] for axis in range(3)])
    else:
        made["normal"] = normal
    if chance.maybe(0.3):
        made["up"] = [1.0, 0.0, 0.1]
    return made | _reading(draft) | _moving(draft, position)


def meters(draft: Draft, width: int, height: int) -> Document:
    """On a grid in the air, as large as a film, of one body, and perhaps in one row more at a point and on a
    plate; keeps clear of bodies."""
    chance = draft.chance
    position, _ = chance.pick(_FILMS)
    corner = shortened([position[0] - 0.2, position[1] + 0.05, position[2] + 0.1])
    grid = {"corner": corner, "right": [0.4, 0, 0], "up": [0, 0, -0.2], "columns": width, "rows": height}
    body = chance.pick(["plane", "cylindrical", "semicylindrical", "hemispherical", "spherical", "fluence"])
    made: Document = {"name": "air", "grid": grid, "measures": body}
    if body == "semicylindrical":
        made["facing"] = [0.3, 0.1, -1.0]
    if chance.maybe(0.4):
        made["normal"] = chance.near([0.1, 1.0, -0.2], 0.3)
    if chance.maybe(0.3):
        grid["border"] = 0.01
    instruments = [made]
    more: Document = {}
    if chance.maybe(0.4):
        above: Document = {"name": "above", "points": [shortened([corner[0], corner[1] + 0.3, corner[2]])]}
        if chance.maybe(0.5):
            above["normals"] = [chance.near([0.2, 1.0, 0.3], 0.3)]
        instruments.append(above)
        if chance.maybe(0.5):
            more["outdoor"] = "above"
    if chance.maybe(0.5):
        instruments.append(_on_plate(draft, corner))
    sensor: Document = {"type": "meters", "instruments": instruments}
    if body == "plane":
        more["colour"] = True
    return sensor | more | _reading(draft) | _moving(draft, corner)


def _on_plate(draft: Draft, corner: Point) -> Document:
    """Meters on faces of a plate of three triangles in the air, which becomes a surface of the scene."""
    chance = draft.chance
    plate: Document = {
        "type": "mesh",
        "vertices": [[0, 0, 0], [0.2, 0.02, 0], [0.2, 0, -0.2], [0, 0.02, -0.2], [-0.1, 0, -0.1]],
        "triangles": [[0, 1, 2], [0, 2, 3], [0, 3, 4]],
        "texture_coordinates": [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 2]],
    }
    surface: Document = {"name": "plate", "shape": plate, "kernel": wall(draft)}
    draft.under_meters.append(
        surface | {"translate": shortened([corner[0] + 0.1, corner[1] + 0.1, corner[2]])}
    )
    faces: Document = {"surface": "plate", "count": chance.whole(1, 2)}
    if chance.maybe(0.4):
        faces["spread"] = chance.maybe(0.8)
    elif chance.maybe(0.5):
        faces["first"] = chance.whole(0, 1)
    if chance.maybe(0.5):
        faces["side"] = chance.pick(["front", "back"])
    if chance.maybe(0.3):
        faces["distance"] = chance.number(0.001, 0.01)
    return {"name": "plate", "faces": faces}


def intensity(draft: Draft, centre: Point, radius: float) -> Document:
    """An intensity meter of the lamps in a ball."""
    chance = draft.chance
    made: Document = {"type": "intensity_meter", "position": centre, "lamp_radius": radius}
    if chance.maybe(0.5):
        made |= {"axis": [0.1, -1.0, 0.2], "zero": [1.0, 0.3, 0.0]}
    return made | _reading(draft) | _moving(draft, centre)


def _moving(draft: Draft, position: Point) -> Document:
    """Of cameras that move; without a scale."""
    if not draft.chance.maybe(0.15):
        return {}
    made = motion(draft, position, 0.05)
    for placement in made.get("placements", []):
        placement.pop("scale", None)
        placement.pop("rotate", None)
        placement["translate"] = draft.chance.near([0.0, 0.0, 0.0], 0.05)
    if "rotate" in made:
        made["rotate"]["degrees"] = draft.chance.number(-10, 10)
    return {"motion": made}


def _reading(draft: Draft) -> Document:
    """Observer, responses, bands, parts of the light."""
    chance = draft.chance
    made: dict[str, Any] = {}
    if chance.maybe(0.2):
        made["observer"] = chance.pick(["CIE 1931 2 degree", "CIE 1964 10 degree"])
    if chance.maybe(0.2):
        made["responses"] = {"eye": coefficient(draft, 0.5), "flat": 1.0}
    if chance.maybe(0.15):
        made["bands"] = {"first": 400, "last": 700, "width": chance.pick([50, 100])}
    if chance.maybe(0.15):
        made["light_parts"] = chance.maybe(0.9)
    if chance.maybe(0.3):
        made["wavelengths"] = chance.pick(["response", "uniform"])
    if made.get("wavelengths") == "uniform":
        made["colour"] = True
    return made
