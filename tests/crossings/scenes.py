"""The grammar: a scene from a seed.

A room, or a floor under the sky; three places with bodies, which are balls that keep clear of each other, of
lamps and of the sensor; media around everything. What a place may hold is in tests/crossings/bodies.py.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from nocturne_scene.spectra.named_responses import RESPONSES
from nocturne_scene.validation.documents import quad

from tests.accuracy.tracing import Document
from tests.crossings import assets, sensors
from tests.crossings.bodies import (
    PLACES,
    RADIUS,
    bodies_at,
    body_across,
    lamp_in_body,
    maps,
    smoke_across,
)
from tests.crossings.chance import Chance, Point, shortened
from tests.crossings.draft import Draft
from tests.crossings.kernels import dielectric, wall
from tests.crossings.lights import disc, environment, important, in_group, lamp
from tests.crossings.media import LAMP_HEIGHT, air, medium
from tests.crossings.shapes import motion, rotation
from tests.crossings.spectra import reflectance, sunlight, warm

SITUATIONS = (
    "a boundary across the sensor",
    "a boundary across a lamp",
    "smoke before the sensor",
    "a far film",
    "a lamp in two media",
    "a layer ends on a surface",
    "rough boundary of equal index",
    "boundary between two indices",
    "things around an intensity meter",
)
"""Situations that had faults, and for which the schema has no field."""
_FILMS = ((8, 8), (8, 8), (4, 4), (12, 8), (10, 6))
_EDGE, _HEIGHT = 3.2, 2.6
"""Of the room, m."""


@dataclass(frozen=True)
class Scene:
    """A document and the film that it is traced on."""

    seed: int
    document: Document
    width: int
    height: int
    wide: bool
    """Whether all lamps are so large that photons meet them by chance."""
    alone: bool = True
    """Whether nothing is outside of an intensity meter's ball."""
    situations: frozenset[str] = frozenset()
    """Of SITUATIONS."""


def scene(seed: int) -> Scene:
    """The same for the same seed."""
    chance = Chance(seed)
    draft = Draft(chance, sharp=chance.maybe(0.65))
    room = chance.maybe(0.5)
    width, height = chance.pick(_FILMS)
    document: Document = {"nocturne": 1, "name": f"crossing {seed}", "surfaces": []}
    document["sensor"] = sensor = _sensor(draft, (width, height), room=room)
    height += any("grid" not in each for each in sensor.get("instruments", []))
    document["surfaces"] += draft.under_meters
    meter = sensor["type"] == "intensity_meter"
    alone = not meter or chance.maybe(0.6)
    if meter:
        document["surfaces"] += lamp_in_body(draft, PLACES[0])
        if alone:
            return _whole(draft, seed, document, width, height)
        draft.situations.add("things around an intensity meter")
    document["surfaces"] += _walls(draft) if room else _ground(draft)
    lamp_at = [chance.number(-0.5, 0.5), LAMP_HEIGHT, chance.number(-0.5, 0.2)]
    far = not room or chance.maybe(0.1)
    if not far or chance.maybe(0.5):
        lit = lamp(draft, lamp_at, chance.number(0.3, 0.45) if draft.sharp else chance.factor(0.05, 0.4))
        if chance.maybe(0.2):
            lit["motion"] = motion(draft, lamp_at, 0.05, of=lit)
        document["surfaces"].append(lit)
    if far:
        _put_sky(draft, document)
    if not room and chance.maybe(0.1):
        document["atmosphere"] = _planet(draft)
    _put_bodies(draft, document, PLACES[1:] if meter else PLACES)
    _put_around(draft, document, far=far)
    if not meter:
        _put_across(draft, document, lamp_at)
    if chance.maybe(0.1):
        _put_lamp_twice(draft, document)
    if chance.maybe(0.2):
        document["important_directions"] = [important(draft, lamp_at, 0.4)]
    if chance.maybe(0.1):
        document["tracing"] = {"maximum_depth": chance.whole(1, 5)}
    return _whole(draft, seed, document, width, height, alone=alone)


def _whole(
    draft: Draft, seed: int, document: Document, width: int, height: int, *, alone: bool = True
) -> Scene:
    if draft.chance.maybe(0.2):
        _put_range(draft, document)
    if draft.chance.maybe(0.2):
        _put_light_groups(draft, document)
    situations = frozenset(draft.situations)
    wide = draft.sharp and not draft.small_lamps
    return Scene(seed, document | draft.named, width, height, wide, alone, situations)


def _put_range(draft: Draft, document: Document) -> None:
    """Other wavelengths, and what a sensor weighs them by."""
    chance, sensor = draft.chance, document["sensor"]
    ranges = [(280, 400), (300, 830), (200, 2500), (900, 1700)]
    written = json.dumps(document | draft.named)
    if '"fluorescence"' in written or '"lamp.xml"' in written:
        # Nothing is absorbed and emitted, or by that lamp, within the others, which is refused.
        ranges = ranges[1:3]
    first, last = chance.pick(ranges)
    document["wavelengths"] = {"first": first, "last": last}
    fitting = [name for name, each in RESPONSES.items() if each.first < last and each.last > first]
    visible = first <= 360 and last >= 830
    if not visible:
        # Its curves are of visible light.
        sensor.pop("responses", None)
        sensor.pop("colour", None)
    if not visible or chance.maybe(0.5):
        sensor["measures"] = chance.pick(fitting)
    if chance.maybe(0.5):
        sensor["named_responses"] = [chance.pick(fitting)]
    if "bands" in sensor:
        sensor["bands"] = {"first": first, "last": last, "width": (last - first) // 2}
    if not visible or chance.maybe(0.3):
        _relight(draft, document)


def _relight(draft: Draft, document: Document) -> None:
    """Gives all lights spectra that are of all wavelengths."""
    for luminaire in _luminaires(draft, document):
        if "radiance" in luminaire:
            luminaire["radiance"] = warm(draft, 300.0)
    sky = document.get("environment")
    if sky is not None:
        hidden_from = {name: sky[name] for name in ("hidden_from",) if name in sky}
        document["environment"] = {"radiance": sunlight(draft, 300.0), **hidden_from}
    for each in document.get("distant", []):
        for field, luminance in (("irradiance", 1000.0), ("radiance", 1e4)):
            if field in each:
                each[field] = sunlight(draft, luminance)


def _luminaires(draft: Draft, document: Document) -> Iterator[Document]:
    """Those of surfaces, also within groups."""
    waiting: list[Any] = [document["surfaces"], draft.named.get("groups", {})]
    while waiting:
        match waiting.pop():
            case {"luminaire": dict() as luminaire}:
                yield luminaire
            case dict() as entries:
                waiting += entries.values()
            case list() as members:
                waiting += members


def _put_light_groups(draft: Draft, document: Document) -> None:
    """Of some lights; others are the rest."""
    if document["sensor"].get("stokes"):
        # Of a group's light nobody knows how it is polarised.
        return
    if document["sensor"].get("colour"):
        # Which has most of the responses that a sensor may have.
        for field in ("bands", "responses", "named_responses"):
            document["sensor"].pop(field, None)
    sky = document.get("environment")
    for light in (*_luminaires(draft, document), *([sky] if sky else []), *document.get("distant", [])):
        if draft.chance.maybe(0.7):
            light["light_group"] = draft.chance.pick(["a", "b"])


def _sensor(draft: Draft, film: tuple[int, int], *, room: bool) -> Document:
    match draft.chance.whole(0, 9):
        case 0 | 1 | 2:
            far = not room and draft.chance.maybe(0.3)
            if far:
                draft.situations.add("a far film")
            return sensors.film(draft, far=far)
        case 3:
            return sensors.intensity(draft, PLACES[0], RADIUS + 0.05)
        case 4 if room:
            return sensors.meters(draft, *film)
    return sensors.camera(draft)


def _walls(draft: Draft) -> list[Document]:
    """Of a room whose corners look inwards."""
    e, h = _EDGE, _HEIGHT
    low, high = -0.5 * e, 0.5 * e
    sides = [
        ([low, 0, low], [0, 0, e], [e, 0, 0]),
        ([low, h, low], [e, 0, 0], [0, 0, e]),
        ([low, 0, low], [e, 0, 0], [0, h, 0]),
        ([low, 0, high], [0, h, 0], [e, 0, 0]),
        ([low, 0, low], [0, h, 0], [0, 0, e]),
        ([high, 0, low], [0, 0, e], [0, h, 0]),
    ]
    return [_wall(draft, quad(*map(list, side))) for side in sides]


def _ground(draft: Draft) -> list[Document]:
    e = 4.0
    made = [_wall(draft, quad([-0.5 * e, 0, -0.5 * e], [0, 0, e], [e, 0, 0]))]
    if draft.chance.maybe(0.3):
        made.append(_wall(draft, quad([-1.5, 0, -1.6], [3, 0, 0], [0, 2, 0])))
    return made


def _wall(draft: Draft, shape: Document) -> Document:
    made: Document = {"shape": shape, "kernel": wall(draft)}
    return made | (maps(draft) if draft.chance.maybe(0.1) else {})


def _put_sky(draft: Draft, document: Document) -> None:
    chance = draft.chance
    sky = chance.maybe(0.7)
    if sky:
        document["environment"] = environment(draft)
    if not sky or chance.maybe(0.5):
        document["distant"] = [disc(draft) for _ in range(chance.whole(1, 2))]


def _planet(draft: Draft) -> Document:
    """The Earth, or a small one whose thick air ends soon."""
    chance = draft.chance
    made: Document = {"altitude": chance.number(0.9, 2.0)}
    earth = chance.maybe(0.5)
    if not earth:
        made |= {"planet_radius": 1e4, "thickness": 300.0}
    if chance.maybe(0.3):
        made["up"] = [0.1, 1.0, 0.0]
    if chance.maybe(0.5):
        made["ground_reflectance"] = reflectance(draft)
    match chance.whole(0, 2):
        case 0:
            made["air"] = None
        case 1:
            height = chance.number(7000, 9000) if earth else chance.number(50, 200)
            made["air"] = {"pressure": chance.number(3e4, 1e5), "scale_height": height}
    if earth and chance.maybe(0.6):
        made["ozone"] = {"dobson_units": 300.0} if chance.maybe(0.5) else {}
    if made.get("air", {}) is None or chance.maybe(0.5):
        made["aerosol"] = {"medium": medium(draft, 3.0), "optical_depth": chance.number(0.05, 0.5)}
        if not earth or chance.maybe(0.5):
            made["aerosol"]["scale_height"] = 60.0
    return made


def _put_bodies(draft: Draft, document: Document, free: list[Point]) -> None:
    """Each at a separate place, by itself or as instances of a group."""
    chance = draft.chance
    places = free[: chance.whole(1, len(free))]
    for place in places:
        if chance.maybe(0.7):
            document["surfaces"] += bodies_at(draft, place, grouped=False)
        else:
            document.setdefault("instances", []).append(
                _instance(draft, place, alone=len(places) == len(free) - 2)
            )


def _instance(draft: Draft, place: Point, *, alone: bool) -> Document:
    """Of a new group; `alone`: the other places are free."""
    chance = draft.chance
    members = bodies_at(draft, [0.0, 0.0, 0.0], grouped=True)
    still = chance.maybe(0.5)
    lamps = [in_group(each, still=still) if "luminaire" in each else each for each in members]
    name = draft.name("groups", lamps)
    made: Document = {"group": name}
    if alone and chance.maybe(0.5):
        return made | {"placements": {"asset": assets.PLACEMENTS}, "translate": [0.0, 0.55, -0.45]}
    if chance.maybe(0.3):
        made["group"] = draft.name("groups", [{"group": name, "rotate": rotation(chance, 180.0)}])
    made["translate"] = place
    if chance.maybe(0.5):
        made["rotate"] = rotation(chance, 180.0)
    if chance.maybe(0.4):
        made["scale"] = chance.number(0.6, 0.8)
        if chance.maybe(0.5) and not still:
            made["motion"] = motion(draft, place, 0.05)
    return made


def _put_around(draft: Draft, document: Document, *, far: bool) -> None:
    """Media, glass or water that hold the whole scene, and air without an end."""
    chance = draft.chance
    if chance.maybe(0.15):
        outer = {"type": "box", "minimum": [-2.2, -0.4, -2.2], "maximum": [2.2, 3.0, 2.2]}
        around: dict[str, Any] = {"shape": outer}
        glass = draft.sharp and chance.maybe(0.3)
        if glass:
            around["kernel"] = dielectric(draft, -1)
        if not glass or chance.maybe(0.4):
            around["interior"] = {"media": [medium(draft, 3.0)]}
        document["surfaces"].append(around)
    if chance.maybe(0.15):
        document["unbounded_media"] = [air(draft, 3.0, even=not far)]


def _put_across(draft: Draft, document: Document, lamp_at: Point) -> None:
    """Bodies whose boundaries cut the sensor or the lamp, and smoke in front of the sensor."""
    chance = draft.chance
    sensor = document["sensor"].get("position", [0.0, 0.5, 1.2])
    if chance.maybe(0.12):
        draft.situations.add("a boundary across the sensor")
        glass = draft.sharp and chance.maybe(0.3)
        document["surfaces"].append(body_across(draft, sensor, chance.number(0.1, 0.3), glass=glass))
    if chance.maybe(0.12):
        draft.situations.add("a boundary across a lamp")
        glass = draft.sharp and chance.maybe(0.3)
        document["surfaces"].append(body_across(draft, lamp_at, chance.number(0.2, 0.5), glass=glass))
    if assets.has_grids() and chance.maybe(0.08):
        draft.situations.add("smoke before the sensor")
        ahead = [0.5 * (sensor[axis] + (0.0, 0.6, 0.2)[axis]) for axis in range(3)]
        document["surfaces"] += smoke_across(draft, shortened(ahead))


def _put_lamp_twice(draft: Draft, document: Document) -> None:
    """Once in a ball of a medium; it may grow there."""
    chance = draft.chance
    draft.situations.add("a lamp in two media")
    group = draft.name("groups", [in_group(lamp(draft, [0.0, 0.0, 0.0], 0.2), still=False)])
    for x in (-0.8, 0.8):
        instance: Document = {"group": group, "translate": [x, 1.9, -0.8]}
        if chance.maybe(0.4):
            part = chance.number(0.7, 1.0)
            still = shortened([(1.0 - part) * each for each in instance["translate"]])
            instance["motion"] = {"placements": [{"scale": 1.0}, {"scale": part, "translate": still}]}
        document.setdefault("instances", []).append(instance)
    ball = {"type": "sphere", "centre": [0.8, 1.9, -0.8], "radius": chance.number(0.22, 0.4)}
    document["surfaces"].append({"shape": ball, "interior": {"media": [medium(draft, 0.5)]}})
