"""Objects at a place of a scene: one or more surfaces within a ball."""

from collections.abc import Callable

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.chance import Point, short, shortened
from tests.crossings.draft import Draft
from tests.crossings.kernels import boundary, dielectric, kernel
from tests.crossings.lights import lamp
from tests.crossings.media import medium, smoke
from tests.crossings.shapes import file_mesh, motion, placed, rotation, standing_box
from tests.crossings.spectra import index, lookup

PLACES: list[Point] = [[-0.7, 0.55, -0.45], [0.7, 0.55, -0.45], [0.0, 0.5, 0.3]]
RADIUS = 0.42
"""Of the ball around a place that holds all that is there, also while it moves."""
_SHIFT = 0.07
"""How far a body moves, m."""
_WITHIN = 0.2 * RADIUS
"""A ball of this radius is inside of any closed body that fills a place and does not move."""


def bodies_at(draft: Draft, centre: Point, *, grouped: bool) -> list[Document]:
    """Something of any kind; `grouped`: for instances, which leave grids where they are."""
    kinds: list[Callable[[Draft, Point], list[Document]]] = [_opaque, _opaque, _file, _filled, _cloud, _pair]
    if not grouped:
        kinds += [_standing] + ([_smoke] if assets.has_grids() else [])
    if draft.sharp:
        kinds += [_glass, _glass, _nested, _overlapping, _matched, _between_indices]
    return draft.chance.pick(kinds)(draft, centre)


def lamp_in_body(draft: Draft, centre: Point) -> list[Document]:
    """A lamp, perhaps with a neighbour, and in glass or a medium, which are at rest around it."""
    chance = draft.chance
    found = [lamp(draft, centre, _WITHIN)]
    if chance.maybe(0.5):
        beside = shortened([centre[axis] + 0.25 * away for axis, away in enumerate(chance.direction())])
        found.append(surface_of(draft, kernel(draft), beside, 0.15))
    if chance.maybe(0.7):
        outer = placed(draft, centre, RADIUS, closed=True, mapped=True)
        if draft.sharp and chance.maybe(0.6):
            outer["kernel"] = dielectric(draft)
        else:
            outer["interior"] = _interior(draft)
        found.append(outer)
    return found


def body_across(draft: Draft, point: Point, radius: float, *, glass: bool) -> Document:
    """A body whose boundary may cut the objects at a point, or pass over them while the shutter is open."""
    chance = draft.chance
    centre = chance.near(point, 1.2 * radius)
    found = placed(draft, centre, radius, closed=True, mapped=glass)
    if glass:
        found["kernel"] = dielectric(draft)
    if not glass or chance.maybe(0.3):
        found["interior"] = _interior(draft)
        if glass:
            # The kernel has one.
            found["interior"].pop("priority", None)
    if chance.maybe(0.4):
        found["motion"] = motion(draft, centre, 0.5 * radius, of=found)
    return found


def smoke_across(draft: Draft, point: Point) -> list[Document]:
    """A grid of smoke around a point."""
    return _smoke(draft, point)


def surface_of(draft: Draft, made: object, centre: Point, radius: float, *, closed: bool = False) -> Document:
    """A surface with a kernel within a ball, which may move and have maps."""
    chance = draft.chance
    maps = _maps(draft) if chance.maybe(0.2) else {}
    moves = chance.maybe(0.2)
    space = radius - _SHIFT if moves else radius
    found = placed(draft, centre, short(space), closed=closed, mapped=bool(maps) or draft.is_mapped(made))
    found |= {"kernel": made, **maps}
    if moves:
        found["motion"] = motion(draft, centre, _SHIFT, of=found)
    return found


def _maps(draft: Draft) -> Document:
    """Shading normals that are not the surface's."""
    if draft.chance.maybe(0.5):
        return {"normal_map": lookup(draft, (assets.NORMALS,))}
    return {"bump_map": lookup(draft, (assets.HEIGHTS,)) | {"height": draft.chance.factor(0.002, 0.02)}}


def maps(draft: Draft) -> Document:
    """Of walls."""
    return _maps(draft)


def _opaque(draft: Draft, centre: Point) -> list[Document]:
    return [surface_of(draft, kernel(draft), centre, RADIUS)]


def _file(draft: Draft, centre: Point) -> list[Document]:
    made = kernel(draft)
    radius = short(draft.chance.number(0.7, 1.0) * RADIUS)
    found = {"shape": file_mesh(draft.chance, mapped=draft.is_mapped(made)), "kernel": made}
    return [found | {"scale": radius, "rotate": rotation(draft.chance, 180.0), "translate": centre}]


def _standing(draft: Draft, centre: Point) -> list[Document]:
    """It touches the floor."""
    chance = draft.chance
    found: Document = {"shape": standing_box(centre, RADIUS, 0.0)}
    if chance.maybe(0.5):
        return [found | {"kernel": kernel(draft)}]
    if draft.sharp and chance.maybe(0.5):
        return [found | {"kernel": dielectric(draft)}]
    return [found | {"interior": {"media": [medium(draft, RADIUS)]}}]


def _filled(draft: Draft, centre: Point) -> list[Document]:
    """Media behind a kernel that lets light in."""
    chance = draft.chance
    inner = chance.pick([{"type": "null"}, _sieve(draft), _paper(draft)])
    found = surface_of(draft, inner, centre, RADIUS, closed=True)
    return [found | {"interior": _interior(draft)}]


def _sieve(draft: Draft) -> Document:
    return {"type": "mask", "kernel": kernel(draft, 1), "opacity": draft.chance.number(0.2, 0.8)}


def _paper(draft: Draft) -> Document:
    return {"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": 0.5}


def _interior(draft: Draft) -> Document:
    chance = draft.chance
    made: Document = {"media": [medium(draft, RADIUS) for _ in range(chance.whole(1, 2))]}
    return made | ({"priority": chance.whole(0, 3)} if chance.maybe(0.4) else {})


def _cloud(draft: Draft, centre: Point) -> list[Document]:
    """Media whose boundary is not seen, and perhaps a thing in them."""
    chance = draft.chance
    found = placed(draft, centre, RADIUS - _SHIFT, closed=True, mapped=False)
    found["interior"] = _interior(draft)
    if chance.maybe(0.3):
        found["motion"] = motion(draft, centre, _SHIFT, of=found)
        return [found]
    return [found] + (_inside(draft, centre) if chance.maybe(0.5) else [])


def _inside(draft: Draft, centre: Point) -> list[Document]:
    if draft.chance.maybe(0.4) and draft.sharp:
        return [lamp(draft, centre, _WITHIN)]
    return [surface_of(draft, kernel(draft), centre, _WITHIN)]


def _pair(draft: Draft, centre: Point) -> list[Document]:
    """Two bodies of media that overlap."""
    return [
        placed(draft, at, 0.6 * RADIUS, closed=True, mapped=False) | {"interior": _interior(draft)}
        for at in _beside(draft, centre)
    ]


def _beside(draft: Draft, centre: Point) -> list[Point]:
    """Two points; balls of 0.6 RADIUS around them are within that of a place."""
    x, y, z = draft.chance.direction()
    away = 0.4 * RADIUS
    return [
        shortened([centre[0] + sign * away * x, centre[1] + sign * away * y, centre[2] + sign * away * z])
        for sign in (-1, 1)
    ]


def _smoke(draft: Draft, centre: Point) -> list[Document]:
    half = 0.5 * assets.VOXELS * assets.VOXEL
    name = smoke(draft, centre, half)
    return [{"shape": {"type": "medium_box", "medium": name}, "interior": {"media": [name]}}]


def _glass(draft: Draft, centre: Point) -> list[Document]:
    found = surface_of(draft, dielectric(draft), centre, RADIUS, closed=True)
    # The kernel has the priority.
    filled = {"interior": {"media": [medium(draft, RADIUS)]}}
    return [found | (filled if draft.chance.maybe(0.4) else {})]


def _nested(draft: Draft, centre: Point) -> list[Document]:
    """Glass with a thing in it: glass of a higher priority, a lamp, anything."""
    chance = draft.chance
    outer: Document = placed(draft, centre, RADIUS, closed=True, mapped=True)
    outer["kernel"] = dielectric(draft, 0)
    if chance.maybe(0.4):
        return [outer, *_inside(draft, centre)]
    inner = placed(draft, centre, 0.25 * RADIUS, closed=True, mapped=True)
    return [outer, inner | {"kernel": dielectric(draft, chance.pick([-1, 1]))}]


def _between_indices(draft: Draft, centre: Point) -> list[Document]:
    """A boundary that bounds no body, around a thing or alone, and perhaps open."""
    chance = draft.chance
    draft.situations.add("boundary between two indices")
    kernel = boundary(draft)
    found = placed(draft, centre, RADIUS, closed=chance.maybe(0.7), mapped=True) | {"kernel": kernel}
    return [found, *(_inside(draft, centre) if chance.maybe(0.4) else [])]


def _matched(draft: Draft, centre: Point) -> list[Document]:
    """Glass in glass of the same index, whose boundary is rough: it scatters nothing."""
    draft.situations.add("rough boundary of equal index")
    made: Document = {"type": "dielectric", "index": index(draft)}
    outer = placed(draft, centre, RADIUS, closed=True, mapped=False) | {"kernel": made}
    inner = placed(draft, centre, 0.3 * RADIUS, closed=True, mapped=False)
    inner["kernel"] = made | {
        "roughness": draft.chance.number(0.1, 0.5),
        "priority": draft.chance.pick([0, 1, -1]),
    }
    if draft.chance.maybe(0.5):
        inner["kernel"]["absorption"] = 1.5
    return [outer, inner]


def _overlapping(draft: Draft, centre: Point) -> list[Document]:
    """Two bodies of glass, or one of them of media, that overlap."""
    one, other = _beside(draft, centre)
    first = placed(draft, one, 0.6 * RADIUS, closed=True, mapped=True) | {"kernel": dielectric(draft, 0)}
    second = placed(draft, other, 0.6 * RADIUS, closed=True, mapped=True)
    if draft.chance.maybe(0.4):
        return [first, second | {"interior": _interior(draft)}]
    return [first, second | {"kernel": dielectric(draft, 1)}]
