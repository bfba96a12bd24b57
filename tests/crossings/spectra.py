"""Spectra, indices of refraction and values that vary, of every kind that a document can have."""

from typing import Any

from nocturne_scene.spectra import indices, published

from tests.accuracy.tracing import Document
from tests.crossings import assets
from tests.crossings.draft import Draft


def reflectance(draft: Draft, high: float = 0.8) -> Any:
    """Below `high` at each wavelength; colours and patches of the chart, which may be above it in the
    infrared, only where `high` is the default."""
    chance = draft.chance
    match chance.whole(0, 5):
        case 0:
            made: Any = chance.number(0.1, high)
        case 1:
            made = {"constant": chance.number(0.1, high)}
        case 2:
            outside = chance.pick(["hold", "zero", None])
            made = draft.thing(table=_knots(draft, 0.05, high), outside=outside)
        case 3 if high >= 0.8:
            made = {"rgb": [chance.number(0.0, high) for _ in range(3)]}
        case 4 if high >= 0.8:
            made = {"chart_patch": chance.pick([*published.CHART_PATCHES])}
        case _:
            made = chance.number(0.1, high)
    return draft.used("spectra", made)


def radiance(draft: Draft, luminance: float) -> Any:
    """Of roughly this luminance, cd/m2."""
    chance = draft.chance
    wanted = float(f"{luminance * chance.number(0.5, 1.5):.3g}")
    # 683 lm/W times the width of the eye's response, 107 nm.
    flat = float(f"{wanted / 7.3e4:.3g}")
    match chance.whole(0, 7):
        case 0:
            made: Any = {"constant": 1.0, "luminance": wanted}
        case 1:
            outside = chance.pick(["hold", "zero", None])
            made = draft.thing(table=_knots(draft, 0.1, 1.0), outside=outside, luminance=wanted)
        case 2:
            made = {"blackbody": chance.number(2000, 8000), "luminance": wanted}
        case 3:
            made = {"illuminant": chance.pick(published.ILLUMINANTS), "luminance": wanted}
        case 4:
            lines = [
                {"nm": chance.number(430, 650), "power": chance.number(0.2, 1.0), "width": width}
                for width in (0.1, chance.number(0.5, 20.0))
            ]
            made = {"lines": lines[: chance.whole(1, 2)], "luminance": wanted}
        case 5:
            made = {"rgb": [chance.number(0.2, 1.0) for _ in range(3)], "luminance": wanted}
        case 6:
            made = {"constant": flat}
        case _:
            made = flat
    return draft.used("spectra", made)


def sunlight(draft: Draft, luminance: float) -> Any:
    """Of about this luminance; of all wavelengths from 280 nm on."""
    chance = draft.chance
    made: Document = {"solar": chance.pick(["extraterrestrial", "global", "direct"])}
    if chance.maybe(0.5):
        return made | {"luminance": float(f"{luminance:.3g}")}
    # The Sun's 1e5 lx.
    return made | {"factor": float(f"{luminance * 1e-5:.3g}")}


def warm(draft: Draft, luminance: float) -> Any:
    """Of about this luminance, and of all wavelengths: as with a colour texture, its spectrum."""
    return {"blackbody": draft.chance.number(2500, 6500), "luminance": float(f"{luminance:.3g}")}


def coefficient(draft: Draft, level: float) -> Any:
    """Per metre, about `level`."""
    chance = draft.chance
    match chance.whole(0, 3):
        case 0:
            made: Any = {"table": _knots(draft, 0.3 * level, 1.7 * level)}
        case 1:
            made = {"rgb": [chance.number(0.0, min(1.0, level)) for _ in range(3)]}
        case 2:
            made = {"constant": chance.number(0.5 * level, 1.5 * level)}
        case _:
            made = chance.number(0.5 * level, 1.5 * level)
    return draft.used("spectra", made)


def plain_coefficient(draft: Draft, level: float) -> Any:
    """Of the kinds that a dielectric's absorption and a depolarisation ratio can have."""
    chance = draft.chance
    made = chance.pick([level, {"constant": level}, {"table": _knots(draft, 0.5 * level, 1.5 * level)}])
    return draft.used("spectra", made)


def _knots(draft: Draft, low: float, high: float) -> list[list[float]]:
    return [[at, draft.chance.number(low, high)] for at in (400.0, 500.0, 560.0, 620.0, 700.0)]


def index(draft: Draft) -> Any:
    """Of something transparent, 1.05 to 2.4."""
    chance = draft.chance
    match chance.whole(0, 4):
        case 0:
            return chance.pick(indices.dielectrics())
        case 1:
            # N-BK7's, from its maker's data sheet.
            b = [1.03961212, 0.231792344, 1.01046945]
            c = [0.00600069867, 0.0200179144, 103.560653]
            return {"sellmeier": {"b": b, "c": c}}
        case 2:
            return {"cauchy": [chance.number(1.3, 1.7), 0.01, 0.0002][: chance.whole(1, 3)]}
        case 3:
            return {"table": [[450.0, chance.number(1.4, 1.8)], [650.0, chance.number(1.05, 1.5)]]}
        case _:
            return chance.number(1.05, 2.0)


def metal(draft: Draft) -> Any:
    """Index of a conductor."""
    chance = draft.chance
    if chance.maybe(0.6):
        return chance.pick(indices.metals())
    k: Any = chance.number(2.0, 6.0)
    if chance.maybe(0.5):
        k = {"table": [[400.0, k], [700.0, chance.number(2.0, 6.0)]]}
    n = chance.pick(
        [chance.number(0.1, 2.0), {"table": [[400.0, 0.2], [700.0, 1.5]]}, {"cauchy": [0.8, 0.05]}]
    )
    return {"n": n, "k": k}


def texture(draft: Draft, names: tuple[str, ...] = assets.TEXTURES) -> Any:
    """A texture, or its name."""
    chance = draft.chance
    made: Document = draft.thing(
        asset=chance.pick(names),
        encoding=chance.pick([None, None, "sRGB", "linear"]),
        wrap=chance.pick([None, "repeat", "clamp"]),
        sharp=chance.pick([None, True, False]),
    )
    return draft.used("textures", made)


def lookup(draft: Draft, names: tuple[str, ...] = assets.TEXTURES) -> Document:
    """The fields that all uses of textures have."""
    chance = draft.chance
    made: Document = {"texture": texture(draft, names)}
    if chance.maybe(0.4):
        made["scale"] = [chance.pick([1.0, 2.0, 3.5, -1.0]), chance.pick([1.0, 2.0])]
    if chance.maybe(0.3):
        made["offset"] = [chance.number(-0.5, 0.5), chance.number(-0.5, 0.5)]
    return made


def colour(draft: Draft, high: float = 0.8) -> Any:
    """A reflectance that may vary over the surface."""
    if not draft.chance.maybe(0.2):
        return reflectance(draft, high)
    made = lookup(draft)
    if high < 0.8 or draft.chance.maybe(0.6):
        made["spectrum"] = reflectance(draft, high)
    if draft.chance.maybe(0.3):
        made["grey"] = draft.chance.maybe(0.7)
    return made


def scalar(draft: Draft, low: float, high: float) -> Any:
    """A number that may vary over the surface between these."""
    chance = draft.chance
    value = chance.number(low, high)
    if not chance.maybe(0.15):
        return value
    return lookup(draft) | {"gain": round(value - low, 4), "bias": low}
