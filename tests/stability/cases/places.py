"""Where things are and how large they are: single precision, and everything that is taken off or added."""

from math import pi

from tests.stability.build import (
    BLACK,
    FURNACE_SOURCE,
    beam,
    box,
    diffuse,
    film,
    furnace,
    lit,
    quad,
    surface,
    walls,
)
from tests.stability.case import Case

_MOVE = "move the scene so that what the sensor sees is near the origin"


def _far(distance: float) -> Case:
    return Case(
        f"furnace at {distance:g} m",
        f"a box of 1 m, {distance:g} m from the origin",
        furnace(0.5, corner=(distance, -distance, distance)),
        2.0 * pi,
        FURNACE_SOURCE,
        samples=1024,
        remedy=_MOVE,
    )


def _scale(edge: float) -> Case:
    return Case(
        f"furnace of {edge:g} m",
        f"everything is {edge:g} m large",
        furnace(0.5, edge),
        2.0 * pi,
        FURNACE_SOURCE,
    )


def _leak(distance: float) -> Case:
    """A bright sky around a closed black box."""
    corner = (distance, distance, distance)
    sensor = film([c + 0.5 for c in corner], [0, 0, 1], 0.5)
    return Case(
        f"dark box at {distance:g} m",
        "a bright sky around a closed box: seams between squares, self-intersection",
        lit(sensor, walls(corner, 1.0, BLACK), sky=1e6),
        0.0,
        "no light gets in",
        remedy=_MOVE,
    )


def _on_the_wall() -> Case:
    document = furnace(0.5)
    document["sensor"] |= {"position": [0.5, 0.5, 0.0]}
    return Case(
        "film on a wall",
        "the film lies exactly in the plane of a wall, facing inwards",
        document,
        2.0 * pi,
        FURNACE_SOURCE,
        remedy="put the film in front of the wall",
    )


def _camera_on_the_wall() -> Case:
    document = furnace(0.5)
    document["sensor"] = {
        "type": "pinhole",
        "position": [0.5, 0.5, 0.0],
        "look_at": [0.5, 0.5, 1.0],
        "vertical_field_of_view_degrees": 90,
    }
    return Case(
        "camera on a wall",
        "the pinhole lies exactly in the plane of a wall",
        document,
        2.0,
        "energy balance: radiance L / (1 - albedo) in a closed box",
        remedy="put the camera in front of the wall",
    )


def _wide_slab(ratio: float) -> Case:
    """Glass that absorbs, far wider than it is thick."""
    glass = {"type": "dielectric", "index": 1.0, "absorption": 1.0}
    plate = surface(box([-ratio, -ratio, -1.0], [ratio, ratio, 0.0]), glass)
    return Case(
        f"absorbing plate {ratio:g} times as wide as thick",
        "rays start off a surface by a part of its size; the skipped distance must absorb, too",
        lit(beam(0.0), [plate, _ceiling(2.0)]),
        0.36787944,
        "Beer and Lambert: exp(-1)",
    )


def _ceiling(z: float) -> dict[str, object]:
    """Black, seen from below: it keeps light from above away."""
    return surface(quad([-1e6, -1e6, z], [2e6, 0, 0], [0, 2e6, 0]))


def _grazing_wall(degrees: float) -> Case:
    wall = surface(quad([-50, -50, 0], [100, 0, 0], [0, 100, 0]), diffuse(0.5))
    return Case(
        f"white wall seen at {degrees:g} degrees",
        "a diffuse wall, all but edge-on",
        lit(beam(degrees, 1e-6), [wall]),
        0.5,
        "radiance of a diffuse wall under an even sky: its albedo",
    )


def _denormal(radiance: float) -> Case:
    document = furnace(0.5, radiance=radiance)
    return Case(
        f"radiance {radiance:g}",
        "linearity: very little or very much light",
        document,
        2.0 * pi * radiance,
        FURNACE_SOURCE,
        remedy="scale the light: images are linear",
    )


CASES = [
    *map(_far, (1e3, 1e5, 1e6, 1e7)),
    *map(_scale, (1e-6, 1e6, 1e9)),
    *map(_leak, (0.0, 1e4, 1e6)),
    _on_the_wall(),
    _camera_on_the_wall(),
    *map(_wide_slab, (1e2, 1e5)),
    *map(_grazing_wall, (89.0, 89.9999)),
    *map(_denormal, (1e-30, 1e19)),
]
