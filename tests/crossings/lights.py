"""Lamps, skies and discs at infinity of every kind."""

from typing import Any

from nocturne_scene.validation.documents import BLACK

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.chance import Point, short
from tests.crossings.draft import Draft
from tests.crossings.kernels import kernel
from tests.crossings.shapes import placed
from tests.crossings.spectra import lookup, radiance

_LUMINANCE = 1000.0
"""Of lamps, cd/m2."""


_SMALL = 0.1
"""Radius of lamps, m, below which photons that are not sent to them meet them seldom (crossing 110879)."""


def lamp(draft: Draft, centre: Point, radius: float) -> Document:
    """A surface that emits, within a ball."""
    chance = draft.chance
    draft.small_lamps = draft.small_lamps or radius < _SMALL
    made = emitter(draft, luminaire(draft))
    if "asset" not in made["luminaire"].get("profile", {}):
        return placed(draft, centre, radius, closed=False, mapped=draft.is_mapped(made)) | made
    shape: Document = {"type": "disc", "centre": centre, "normal": [0, -1, 0], "radius": short(radius)}
    if chance.maybe(0.4):
        shape = {"type": "sphere", "centre": centre, "radius": short(radius)}
    return {"shape": shape} | made


def in_group(made: Document, *, still: bool) -> Document:
    """The lamp; where instances move, without a flux and without a file, which are of one surface at rest."""
    if still and "motion" not in made:
        return made
    kept = dict(made["luminaire"])
    for name in ("lumens", "watts"):
        kept.pop(name, None)
    if "asset" in kept.get("profile", {}):
        del kept["profile"]
        kept.setdefault("radiance", _LUMINANCE / 500.0)
    return made | {"luminaire": kept}


def emitter(draft: Draft, made: Document) -> Document:
    """The fields of a surface that have to do with its emission: mostly black."""
    chance = draft.chance
    emits = {"luminaire": made}
    if chance.maybe(0.15):
        return emits | {"kernel": {"type": "null"}}
    if chance.maybe(0.2):
        mask = {"type": "mask", "kernel": BLACK, "opacity": chance.number(0.3, 0.9)}
        return emits | {"kernel": mask}
    return emits | {"kernel": kernel(draft, 1) if chance.maybe(0.3) else BLACK}


def luminaire(draft: Draft, level: float = _LUMINANCE) -> Document:
    """What makes a surface emit about so many cd/m2."""
    chance = draft.chance
    made: Document = {"radiance": radiance(draft, level)}
    varies = chance.maybe(0.15)
    if varies:
        made["radiance"] = lookup(draft) | {"spectrum": made["radiance"]}
    # What varies has the radiance that it says.
    match chance.whole(3 if varies else 0, 7):
        case 0:
            made["lumens"] = chance.factor(500.0, 2000.0)
        case 1:
            made["watts"] = chance.factor(3.0, 15.0)
        case 2:
            made["exitance"] = chance.factor(1000.0, 4000.0)
        case 3 if not varies:
            made["profile"] = _photometric(draft)
            if made["profile"]["asset"].endswith(".xml") and chance.maybe(0.5):
                # The file's own.
                del made["radiance"]
    if chance.maybe(0.15) and "profile" not in made:
        made["profile"] = {"cosine_power": chance.number(0.0, 4.0)}
    if chance.maybe(0.5):
        made["two_sided"] = chance.maybe(0.8)
    for name in ("dimming", "maintenance_factor"):
        if chance.maybe(0.15):
            made[name] = chance.number(0.3, 1.0)
    return made | hidden(draft)


def _photometric(draft: Draft) -> Document:
    chance = draft.chance
    made: Document = {"asset": chance.pick(list(assets.PROFILES))}
    if chance.maybe(0.5):
        made["lumens"] = chance.factor(500.0, 2000.0)
    if chance.maybe(0.5):
        made |= {"axis": [chance.number(-0.3, 0.3), -1.0, 0.1], "zero": [0.2, 0.0, 1.0]}
    return made


def hidden(draft: Draft) -> Document:
    chance = draft.chance
    return {"hidden_from": chance.pick(["camera", "camera_and_mirrors"])} if chance.maybe(0.2) else {}


def environment(draft: Draft) -> Document:
    chance = draft.chance
    match chance.whole(0, 3):
        case 0:
            return {"radiance": radiance(draft, 300.0)} | hidden(draft)
        case 1:
            made: Document = {"asset": assets.SKY, "luminance": chance.factor(50.0, 200.0)}
            if chance.maybe(0.5):
                made |= {"up": [0.1, 1.0, 0.2], "forward": [chance.number(-1, 1), 0.0, -1.0]}
            if chance.maybe(0.4):
                made["pixels"] = chance.pick(["areas", "points"])
            if chance.maybe(0.4):
                made["rotate_degrees"] = chance.number(-180, 180)
            return made | hidden(draft)
        case 2:
            return _standard_sky(draft) | hidden(draft)
        case _:
            return _weather_sky(draft) | hidden(draft)


def _standard_sky(draft: Draft) -> Document:
    chance = draft.chance
    made: Document = {"cie": chance.whole(1, 16)} | _sun(draft)
    made |= {"zenith_luminance": 300.0} if chance.maybe(0.5) else {"illuminance": 1000.0}
    # As `disc`: mirrors and glass gather the light of a small one.
    if not draft.sharp and chance.maybe(0.3):
        made["sun_illuminance"] = 500.0
    return made


def _weather_sky(draft: Draft) -> Document:
    chance = draft.chance
    made: Document = {"diffuse_horizontal": chance.factor(5.0, 10.0)} | _sun(draft)
    made["direct_normal"] = 0.0 if chance.maybe(0.2) else chance.factor(5.0, 10.0)
    if chance.maybe(0.3):
        made["dew_point"] = chance.number(-10.0, 20.0)
    if draft.sharp or chance.maybe(0.3):
        made["without_sun"] = True
    return made


def _sun(draft: Draft) -> Document:
    chance = draft.chance
    up: Document = {"up": [0.1, 1.0, 0.0]} if chance.maybe(0.3) else {}
    if chance.maybe(0.5):
        return {"sun": _upwards(draft)} | up
    place: Document = {"latitude": chance.number(-60.0, 60.0), "longitude": 8.0}
    if chance.maybe(0.5):
        place |= {"altitude": chance.number(0.0, 3000.0), "north": [1.0, 0.0, chance.number(-1.0, 1.0)]}
    return {"place": place, "time": f"2026-03-21T{chance.whole(8, 14):02}:00Z"} | up


def disc(draft: Draft) -> Document:
    """A Sun; a wide one where mirrors or glass may gather its light."""
    chance = draft.chance
    made: Document = {"direction": _upwards(draft)}
    degrees = chance.number(15.0, 60.0)
    solid_angle = 6.28 * (1.0 - 0.5 * (1.0 + _cosine(degrees)))
    if draft.sharp or chance.maybe(0.5):
        made["angular_diameter_degrees"] = degrees
    else:
        solid_angle = 6.8e-5
    match chance.whole(0, 2):
        case 0:
            made["radiance"] = radiance(draft, 1000.0 / solid_angle)
        case 1:
            made["irradiance"] = radiance(draft, 1000.0)
        case _:
            made["sun"] = True
    if chance.maybe(0.4):
        made["limb_darkening"] = chance.maybe(0.7)
    return made | hidden(draft)


def _cosine(degrees: float) -> float:
    from math import cos, radians

    return cos(radians(degrees))


def _upwards(draft: Draft) -> Point:
    chance = draft.chance
    return [chance.number(-1.0, 1.0), chance.number(0.5, 1.5), chance.number(-1.0, 1.0)]


def important(draft: Draft, centre: Point, radius: float) -> Any:
    """Something worth looking at."""
    made = placed(draft, centre, radius, closed=False, mapped=False)
    return made | ({"weight": draft.chance.number(0.5, 2.0)} if draft.chance.maybe(0.4) else {})
