"""Media of every kind, of an optical depth that light gets through."""

from math import gamma, pi
from typing import Any

import numpy as np
from nocturne_scene.media import presets
from nocturne_scene.spectra.published import visible_wavelengths

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.chance import Point, short
from tests.crossings.draft import Draft
from tests.crossings.shapes import rotation
from tests.crossings.spectra import coefficient, plain_coefficient

LAMP_HEIGHT = 2.05
"""Of the lamp above the floor, m."""
_DROPLETS: tuple[Document, ...] = (
    {"mode_radius": 3e-7, "alpha": 4.0},
    {"mode_radius": 1e-6, "alpha": 6.0, "gamma": 1.5, "index": "water"},
    {"mode_radius": 2e-7, "alpha": 3.0, "index": {"cauchy": [1.4, 0.003]}},
)


def medium(draft: Draft, size: float) -> str:
    """The name of a medium whose optical depth over `size` metres is 0.1 to 2."""
    made, level = _kind(draft, draft.chance.factor(0.1, 2.0) / size)
    # Dyes are everywhere alike, or in a grid: where they thin out by altitude they are refused.
    density = level if "fluorescence" in made else _density(draft, level, size, even=True)
    if density != 1.0:
        made["density"] = density
    return draft.name("media", made)


def air(draft: Draft, size: float, *, even: bool) -> str:
    """The same of a medium without bounds; `even`: perhaps the same everywhere, so that no light gets here
    from infinitely far away. Without an end it absorbs: light that only scatters would wander in it for
    long."""
    level = short(draft.chance.factor(0.1, 1.0) / size)
    density = _density(draft, 1.0, size, even=even)
    # In layers light only scatters until it leaves them.
    has_end = isinstance(density, dict) and "layers" in density
    made: Document = {}
    if not has_end or draft.chance.maybe(0.7):
        made["absorption"] = coefficient(draft, level)
    if not made or draft.chance.maybe(0.8):
        made |= {"scattering": coefficient(draft, level), "phase": _phase(draft)}
    return draft.name("media", made | ({"density": density} if density != 1.0 else {}))


def smoke(draft: Draft, centre: Point, grid_size: float) -> str:
    """The name of a medium whose density is a grid around a point; it may glow."""
    chance = draft.chance
    made, level = _kind(draft, chance.factor(0.3, 2.0) / grid_size)
    where: Document = {"translate": centre}
    if chance.maybe(0.5):
        where["rotate"] = rotation(chance, 180.0)
    if chance.maybe(0.3):
        where["scale"] = chance.number(0.8, 1.0)
    nearest = {"nearest": True} if chance.maybe(0.4) else {}
    grid = {"asset": assets.GRIDS, "grid": "density", "factor": level, **where, **nearest}
    made["density"] = grid
    if "absorption" in made and "fluorescence" not in made and chance.maybe(0.7):
        made["temperature"] = {"asset": assets.GRIDS, "grid": "temperature", **where, **nearest}
        # A black body of 2000 K has 4e5 cd/m2.
        made["emission_scale"] = chance.factor(1e-3, 1e-2)
    return draft.name("media", made)


def _kind(draft: Draft, per_metre: float) -> tuple[Document, float]:
    """Fields of a medium, and the density at which its extinction is so much."""
    chance = draft.chance
    match chance.whole(0, 5):
        case 0:
            name = chance.pick(presets.names())
            return {"preset": name}, short(per_metre / _extinction(name))
        case 1:
            droplets = _droplets(draft)
            return {"droplets": droplets}, short(per_metre / _of_droplets(**_numbers(droplets)))
    level = short(per_metre)
    made: Document = {}
    if chance.maybe(0.7):
        made["scattering"] = coefficient(draft, level)
        if chance.maybe(0.8):
            made["phase"] = _phase(draft)
    if not made or chance.maybe(0.5):
        made["absorption"] = coefficient(draft, short(0.4 * level))
    if chance.maybe(0.05):
        made["fluorescence"] = [_dye(draft, level)]
    return made, 1.0


def _dye(draft: Draft, level: float) -> Document:
    chance = draft.chance
    made: Document = {
        "absorption": {"table": [[380, short(0.3 * level)], [450, short(level)], [560, 0.0]]},
        "emission": {"table": [[480, 0.0], [530, 1.0], [600, chance.number(0.1, 0.9)], [680, 0.0]]},
    }
    return made | ({"quantum_yield": chance.number(0.3, 1.0)} if chance.maybe(0.5) else {})


def _extinction(name: str) -> float:
    """Of a preset, 1/m, the mean over wavelengths."""
    if name in presets.droplets():
        return _of_droplets(**_numbers(presets.droplets()[name]))
    found = presets.coefficients(name)
    assert len(found.scattering) == len(visible_wavelengths())
    return float(np.mean(found.absorption + found.scattering))


def _numbers(droplets: Document) -> dict[str, float]:
    return {"gamma_": 1.0, "number": 1e8} | {
        {"gamma": "gamma_"}.get(name, name): value
        for name, value in droplets.items()
        if not isinstance(value, str | dict) and name != "index"
    }


def _of_droplets(mode_radius: float, alpha: float, gamma_: float, number: float) -> float:
    """Twice the area of all droplets, 1/m: what large ones take of the light."""
    squares = gamma((alpha + 3) / gamma_) / gamma((alpha + 1) / gamma_) * (alpha / gamma_) ** (-2 / gamma_)
    return float(2.0 * pi * mode_radius**2 * squares * number)


def _droplets(draft: Draft) -> Document:
    """Of few kinds: each takes a second when it is compiled first."""
    made = dict(draft.chance.pick(_DROPLETS))
    return made | ({"number": draft.chance.factor(1e7, 1e9)} if draft.chance.maybe(0.4) else {})


def _phase(draft: Draft) -> Document:
    chance = draft.chance
    match chance.whole(0, 5):
        case 0:
            return {"type": "isotropic"}
        case 1:
            return {"type": "henyey_greenstein", "g": chance.number(-0.5, 0.8)}
        case 2:
            first, second = chance.number(0.2, 0.8), chance.number(-0.5, 0.0)
            made = {"type": "double_henyey_greenstein", "first": first, "second": second}
            return made | {"weight": chance.number(0.2, 0.9)}
        case 3:
            made = {"type": "rayleigh"}
            return made | ({"depolarisation": plain_coefficient(draft, 0.1)} if chance.maybe(0.5) else {})
        case 4:
            rows = chance.whole(1, 2)
            values = [[chance.number(0.1, 1.0) for _ in range(4)] for _ in range(rows)]
            made = {"type": "tabulated", "cosines": [-1.0, -0.3, 0.5, 1.0], "values": values}
            if chance.maybe(0.6):
                made["matrix"] = _matrix(draft, rows)
            return made | ({"wavelengths": [450.0, 650.0]} if rows == 2 else {})
        case _:
            return {"type": "mie", "droplets": _droplets(draft)}


def _matrix(draft: Draft, rows: int) -> Document:
    """Elements that leave no light more than wholly polarised."""
    chance = draft.chance

    def table(low: float, high: float) -> list[list[float]]:
        return [[chance.number(low, high) for _ in range(4)] for _ in range(rows)]

    made: Document = {"s12": table(-0.3, 0.3), "s33": table(-0.3, 0.3), "s34": table(-0.2, 0.2)}
    if chance.maybe(0.5):
        made |= {"s22": table(0.6, 0.8)}
        if chance.maybe(0.7):
            made["s44"] = [[short(value + chance.number(-0.1, 0.1)) for value in row] for row in made["s33"]]
    return made


def _density(draft: Draft, level: float, size: float, *, even: bool) -> Any:
    """About `level` where the scene is."""
    chance = draft.chance
    match chance.whole(0 if even else 2, 4):
        case 2:
            # Below the ground it grows without an end, so there is little of it up here.
            made: Document = {"scale_height": short(size * chance.number(0.4, 1.0))}
            if level != 1.0 or chance.maybe(0.5):
                made["at_ground"] = short(level * chance.number(1.0, 2.0))
        case 3 | 4:
            layers = [[-0.5, 0.0], [0.3, level], [1.0, short(0.4 * level)], [3.3, 0.0]]
            made = {"layers": layers[chance.whole(0, 1) :]}
            if chance.maybe(0.4):
                # It ends where the floor is, and where the lamp hangs.
                draft.situations.add("a layer ends on a surface")
                return {"layers": [[0.0, level], [LAMP_HEIGHT, short(0.5 * level)]]}
        case _:
            return level
    match chance.whole(0, 3):
        case 0:
            made["above"] = {"centre": [chance.number(-0.5, 0.5), -20.0, 0.3], "radius": 20.0}
        case 1:
            up = {"up": [chance.number(-0.3, 0.3), 1.0, chance.number(-0.3, 0.3)]}
            made["above"] = {"point": [0.2, 0.1, 0.0]} | (up if chance.maybe(0.7) else {})
    return made
