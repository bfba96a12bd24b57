"""Kernels of every type, and kernels inside kernels."""

from typing import Any

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.draft import Draft
from tests.crossings.spectra import colour, index, metal, plain_coefficient, reflectance, scalar

_ROUGHEST = 0.6
_ROUGH = 0.25
"""From here on lamps of any size are found."""


def kernel(draft: Draft, depth: int = 0) -> Any:
    """Of a surface that bounds no body, or its name."""
    simple = (_lambertian, _lambertian, _transmitter, _phong, _measured, _coated, _principled, _conductor)
    sharp = (_pane, _glazing, _null) if draft.sharp else ()
    compound = (_blend, _mask, _two_sided) if depth < 2 else ()
    # In no blend and no mask.
    alone = (_fluorescent, *((_filter,) if draft.sharp else ())) if depth == 0 else ()
    made = draft.chance.pick([*simple, *sharp, *compound, *alone])(draft, depth)
    return draft.used("kernels", made)


def wall(draft: Draft) -> Any:
    """Of a large surface: mostly diffuse."""
    return kernel(draft, 1) if draft.chance.maybe(0.25) else draft.used("kernels", _lambertian(draft, 0))


def dielectric(draft: Draft, priority: int | None = None) -> Any:
    """Of a body's boundary, or its name."""
    chance = draft.chance
    made: Document = {"type": "dielectric", "index": index(draft)}
    if chance.maybe(0.1):
        # Nothing is reflected or refracted.
        made["index"] = 1.0
    if chance.maybe(0.4):
        made |= _facets(draft)
    if chance.maybe(0.2) and (made["index"] != 1.0 or not any(name.startswith("rough") for name in made)):
        made["coating"] = _layers(draft)
    if chance.maybe(0.4):
        made["absorption"] = plain_coefficient(draft, chance.number(0.2, 3.0))
    if priority is not None:
        made["priority"] = priority
    match chance.whole(0, 9):
        case 0:
            return {"type": "mask", "kernel": made, "opacity": scalar(draft, 0.2, 0.9)}
        case 1:
            other = {"type": "lambertian", "reflectance": reflectance(draft)}
            return {"type": "blend", "first": made, "second": other, "weight": scalar(draft, 0.1, 0.6)}
    return draft.used("kernels", made)


def boundary(draft: Draft) -> Any:
    """A dielectric that has an index on either side, or its name."""
    made: Document = {"type": "dielectric", "index": index(draft), "outside": index(draft)}
    if draft.chance.maybe(0.4):
        made |= _facets(draft)
    return draft.used("kernels", made)


def _facets(draft: Draft) -> Document:
    """Roughness of microfacets, or nothing where they may be polished."""
    chance = draft.chance
    low = 0.02 if draft.sharp else _ROUGH
    made: Document = {}
    if draft.sharp and chance.maybe(0.3):
        return {"roughness": 0.0} if chance.maybe(0.3) else made
    if chance.maybe(0.3):
        made |= {f"roughness_{axis}": scalar(draft, low, _ROUGHEST) for axis in "uv"}
    else:
        made["roughness"] = scalar(draft, low, _ROUGHEST)
    if chance.maybe(0.5):
        made["distribution"] = chance.pick(["ggx", "beckmann"])
    return made


def _lambertian(draft: Draft, depth: int) -> Document:
    return {"type": "lambertian", "reflectance": colour(draft)}


def _fluorescent(draft: Draft, depth: int) -> Document:
    """Of one dye, or by a matrix."""
    chance = draft.chance
    if chance.maybe(0.5):
        low, high = chance.number(0.05, 0.2), chance.number(0.2, 0.5)
        glow: Document = {
            "absorption": {"table": [[380, low], [450, high], [560, 0.0]]},
            "emission": {"table": [[480, 0.0], [530, 1.0], [600, chance.number(0.1, 0.9)], [680, 0.0]]},
        }
        if chance.maybe(0.5):
            glow["quantum_yield"] = chance.number(0.3, 1.0)
    else:
        rows = [[chance.number(0.0, 3e-3) for _ in range(3)] for _ in range(2)]
        glow = {"excitation_nm": [400, 520], "emission_nm": [500, 570, 650], "values": rows}
    return {"type": "lambertian", "reflectance": chance.number(0.1, 0.4), "fluorescence": [glow]}


def _filter(draft: Draft, depth: int) -> Document:
    """A polariser or a wave plate."""
    chance = draft.chance
    axis = [chance.number(-1.0, 1.0), chance.number(-1.0, 1.0), 1.0]
    match chance.whole(0, 3):
        case 0:
            return {"type": "retarder", "axis": axis, "retardance_nm": chance.number(50, 900)}
        case 1:
            return {"type": "retarder", "axis": axis, "retardance_degrees": chance.number(10, 350)}
    made: Document = {"type": "polariser", "axis": axis}
    if chance.maybe(0.5):
        made |= {"transmittance": reflectance(draft), "leakage": chance.number(0.0, 0.3)}
    return made


def _transmitter(draft: Draft, depth: int) -> Document:
    return {
        "type": "diffuse_transmitter",
        "reflectance": colour(draft, 0.4),
        "transmittance": colour(draft, 0.4),
    }


def _conductor(draft: Draft, depth: int) -> Document:
    made: Document = {"type": "conductor", "index": metal(draft), **_facets(draft)}
    if draft.chance.maybe(0.25):
        made["coating"] = _layers(draft)
    return made


def _pane(draft: Draft, depth: int) -> Document:
    made: Document = {"type": "thin_pane", "index": index(draft)}
    if draft.chance.maybe(0.5):
        made["transmittance"] = reflectance(draft)
    return made


def _layers(draft: Draft) -> list[Document]:
    """Of a thin film, clear ones and metals so thin that light comes through."""
    chance = draft.chance
    made = []
    for _ in range(chance.whole(1, 3)):
        clear = chance.maybe(0.7)
        of = index(draft) if clear else metal(draft)
        made.append({"index": of, "thickness_nm": chance.number(20, 600) if clear else chance.number(2, 15)})
    return made


def _glazing(draft: Draft, depth: int) -> Document:
    """Panes by stacks and by numbers."""
    chance = draft.chance
    panes = []
    for _ in range(chance.whole(1, 3)):
        match chance.whole(0, 2):
            case 0:
                pane: Document = {"index": index(draft)}
                if chance.maybe(0.5):
                    pane["transmittance"] = reflectance(draft)
                pane |= {side: _layers(draft) for side in ("front", "back") if chance.maybe(0.4)}
            case 1:
                pane = {"film": _layers(draft)}
            case _:
                fields = ("front_reflectance", "back_reflectance", "transmittance")
                pane = {name: reflectance(draft, 0.45) for name in fields}
        panes.append(pane)
    return {"type": "glazing", "panes": panes}


def _coated(draft: Draft, depth: int) -> Document:
    made = {"type": "coated_diffuse", "index": index(draft), "reflectance": colour(draft)}
    return made | _facets(draft)


def _phong(draft: Draft, depth: int) -> Document:
    exponent = draft.chance.factor(1.0, 200.0 if draft.sharp else 10.0)
    return {"type": "phong", "reflectance": colour(draft), "exponent": exponent}


def _measured(draft: Draft, depth: int) -> Document:
    return {"type": "measured", "asset": assets.MEASURED, "format": "table"}


def _principled(draft: Draft, depth: int) -> Document:
    chance = draft.chance
    low = 0.15 if draft.sharp else 0.5
    made: Document = {"type": "principled", "base": colour(draft)}
    optional: dict[str, Any] = {
        "metallic": lambda: scalar(draft, 0.0, 1.0),
        "roughness": lambda: scalar(draft, low, 1.0),
        "index": lambda: index(draft),
        "coat": lambda: scalar(draft, 0.0, 1.0),
        "coat_index": lambda: chance.number(1.2, 2.0),
        "specular": lambda: scalar(draft, 0.0, 1.0),
        "specular_colour": lambda: colour(draft),
        "roughness_across": lambda: scalar(draft, low, 1.0),
        "rotation": lambda: scalar(draft, 0.0, 1.0),
        "sheen": lambda: colour(draft),
        "sheen_roughness": lambda: scalar(draft, 0.2, 1.0),
    }
    made |= {name: value() for name, value in optional.items() if chance.maybe(0.35)}
    if "coat" in made and (not draft.sharp or chance.maybe(0.6)):
        made["coat_roughness"] = scalar(draft, low, 1.0)
    return made


def _null(draft: Draft, depth: int) -> Document:
    """In a blend: alone it would be left out."""
    other = {"type": "lambertian", "reflectance": reflectance(draft)}
    return {"type": "blend", "first": other, "second": {"type": "null"}, "weight": scalar(draft, 0.1, 0.9)}


def _blend(draft: Draft, depth: int) -> Document:
    first, second = kernel(draft, depth + 1), kernel(draft, depth + 1)
    return {"type": "blend", "first": first, "second": second, "weight": scalar(draft, 0.1, 0.9)}


def _mask(draft: Draft, depth: int) -> Document:
    return {"type": "mask", "kernel": kernel(draft, depth + 1), "opacity": scalar(draft, 0.1, 0.9)}


def _two_sided(draft: Draft, depth: int) -> Document:
    """Of sides that let the same light through, or none."""
    chance = draft.chance
    if chance.maybe(0.2):
        front = _transmitter(draft, depth)
        return {"type": "two_sided", "front": front, "back": front | {"reflectance": colour(draft, 0.4)}}
    opaque = (_lambertian, _phong, _measured, _coated, _principled, _conductor)
    front, back = (draft.used("kernels", chance.pick(opaque)(draft, depth + 1)) for _ in range(2))
    return {"type": "two_sided", "front": front, "back": back}
