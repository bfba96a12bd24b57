"""Things that move while the shutter is open."""

from math import pi

from tests.accuracy.tracing import Document
from tests.stability.build import FURNACE_SOURCE, beam, box, diffuse, furnace, lit, quad, surface
from tests.stability.case import Case


def _together(distance: float) -> Case:
    """The sensor and all that it sees."""
    document = furnace(0.5)
    motion = {"motion": {"translate": [distance, -distance, distance]}}
    document["sensor"] |= motion
    for wall in document["surfaces"]:
        wall |= motion
    return Case(
        f"everything moves {distance:g} m",
        "sensor and box of 1 m move together",
        document,
        2.0 * pi,
        FURNACE_SOURCE,
        remedy="keep objects still that do not move against the sensor",
    )


def _passing(distance: float) -> Case:
    """A black bar of 1 m passes a camera that sees a point."""
    bar = surface(quad([-distance, -5, 0], [1, 0, 0], [0, 10, 0]))
    bar["motion"] = {"translate": [2.0 * distance, 0, 0]}
    return Case(
        f"a bar passes {2.0 * distance:g} m in the shutter's time",
        "what moves far is there for a short time",
        lit(beam(0.0, 1e-3), [bar]),
        1.0 - 1.0 / (2.0 * distance),
        "time that the bar covers the point: its width over the distance",
        samples=1024,
        allowed=1e-4,
    )


def _turning() -> Case:
    cube = surface(box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]), diffuse(1.0))
    cube["motion"] = {"rotate": {"axis": [1, 2, 3], "degrees": 360}}
    return Case(
        "a white cube turns once",
        "faces that move and meet their own shadow",
        lit(beam(0.0, 1.9, 5.0), [cube]),
        1.0,
        "a white convex body in even light can't be seen",
    )


def _turning_glass() -> Case:
    glass: Document = {"type": "dielectric", "index": 1.5}
    cube = surface(box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]), glass)
    cube["motion"] = {"rotate": {"axis": [1, 2, 3], "degrees": 360}}
    return Case(
        "a clear cube turns once",
        "refraction by faces that move",
        lit(beam(0.0, 1.9, 5.0), [cube]),
        1.0,
        "clear glass in even light can't be seen",
    )


CASES = [*map(_together, (1.0, 1e4, 1e6)), *map(_passing, (10.0, 100.0)), _turning(), _turning_glass()]
