"""Requirements of the light of a place, by a standard or by hand, and how sure it is that they hold."""

from dataclasses import dataclass, fields
from typing import Literal, NamedTuple

from scipy import stats

from nocturne_scene.errors import InputError

SURE = 0.95
"""Probability from which on a requirement holds or fails; between, it is open."""

Verdict = Literal["holds", "fails", "open"]


@dataclass(frozen=True)
class Requirement:
    """Limits; None: not asked for."""

    name: str
    em: float | None = None
    """Mean illuminance of the task area, lx, maintained; at least."""
    u0: float | None = None
    """Least over mean illuminance of the task area; at least."""
    ugr: float | None = None
    """Unified glare rating; at most."""
    ra: float | None = None
    """Colour rendering index of the light that arrives; at least."""
    ez: float | None = None
    """Mean cylindrical illuminance, lx; at least."""
    df: float | None = None
    """Mean daylight factor, %; at least."""
    sda: float | None = None
    """Part of the points with daylight enough, %; at least."""


# EN 12464-1:2021, Table 34, offices: required values, not the modified ones. The standard's means for walls
# and ceiling are not in here, as scenes do not say which meters are theirs. The table is not public: of rows
# other than _PUBLISHED no public text was found that has all of these numbers, and a report says so.
_OFFICES = {
    "34.1": ("filing, copying", 300, 0.40, 19, 80, None),
    "34.2": ("writing, typing, reading, data processing", 500, 0.60, 19, 80, 150),
    "34.3": ("technical drawing", 750, 0.70, 16, 80, None),
    "34.4": ("CAD workstations", 500, 0.60, 19, 80, None),
    "34.5": ("conference and meeting rooms", 500, 0.60, 19, 80, None),
    "34.6": ("reception desk", 300, 0.60, 22, 80, None),
    "34.7": ("archiving", 200, 0.40, 25, 80, None),
}
_STANDARD = "EN 12464-1"
_PUBLISHED = "34.2"
UNCHECKED = "limits not checked against a published table"


def requirement(text: str) -> Requirement:
    """From `EN 12464-1:34.2` or `Em=500,U0=0.6,UGR=19`. Raises InputError."""
    given = text.strip()
    if given.upper().startswith(_STANDARD):
        row = given[len(_STANDARD) :].strip(" :").removeprefix("2021").strip(" :,")
        if row not in _OFFICES:
            raise InputError.at("", f"{text}: expected {_STANDARD}: and one of {', '.join(_OFFICES)}")
        name, em, u0, ugr, ra, ez = _OFFICES[row]
        note = "" if row == _PUBLISHED else f" ({UNCHECKED})"
        return Requirement(f"{_STANDARD}:2021, {row} {name}{note}", em, u0, ugr, ra, ez)
    known = {each.name: each.name for each in fields(Requirement) if each.name != "name"}
    found: dict[str, float] = {}
    for part in given.split(","):
        name, equals, value = part.partition("=")
        key = known.get(name.strip().lower())
        try:
            number = float(value)
        except ValueError:
            number = -1.0
        if key is None or not equals or not 0.0 < number < 1e6:
            names = "Em, U0, UGR, Ra, Ez, DF, sDA"
            raise InputError.at("", f"{text}: expected {_STANDARD}:34.2, or such as Em=500,U0=0.6 of {names}")
        found[key] = number
    return Requirement(given, **found)


class Certainty(NamedTuple):
    """Probabilities that a requirement holds, and that it fails; each at least."""

    holds: float
    fails: float

    @property
    def verdict(self) -> Verdict:
        """Open where neither is sure."""
        return "holds" if self.holds >= SURE else "fails" if self.fails >= SURE else "open"


def certainty(value: float, error: float | None, limit: float, *, at_most: bool = False) -> Certainty:
    """Of a value with its standard error; without one, nothing is known."""
    if error is None or error != error or value != value:
        return Certainty(0.0, 0.0)
    distance = limit - value if at_most else value - limit
    holds = float(distance >= 0.0) if error <= 0.0 else float(stats.norm.cdf(distance / error))
    return Certainty(holds, 1.0 - holds)


def together(parts: list[Certainty]) -> Certainty:
    """Of all: they hold together at least by 1 less the sum of doubts (Bonferroni), and one that fails is
    enough."""
    doubts = sum(1.0 - each.holds for each in parts)
    return Certainty(max(0.0, 1.0 - doubts), max((each.fails for each in parts), default=0.0))
