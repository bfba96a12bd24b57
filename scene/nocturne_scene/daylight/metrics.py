"""Figures of a year of daylight, with intervals from independent batches.

IES LM-83-12: spatial daylight autonomy (sDA300,50%) and annual sunlight exposure (ASE1000,250h), over the
hours from 8:00 to 18:00. Daylight autonomy and its continuous form: C. Reinhart, J. Mardaljevic, Z. Rogers,
Leukos 3 (2006) 7. Useful daylight illuminance with its limits of 100, 300 and 3000 lx: J. Mardaljevic and
others, "Daylighting, artificial lighting and non-visual effects study for a residential building", 2012.
Simplified daylight glare probability, of an eye that sees no Sun: J. Wienold, "Dynamic simulation of blind
control strategies for visual comfort and energy balance analysis", Building Simulation 2007. Melanopic
equivalent daylight illuminance by day of 250 lx or more at the eye: T. Brown and others, PLoS Biology 20
(2022) e3001571. Provision of daylight, by hours: EN 17037:2018, table A.1, least level: 300 lx over half of
the area and 100 lx over 95 % of it, each in half of the daylight hours, which are half of the year.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from nocturne_scene.daylight.coefficients import Illuminances
from nocturne_scene.spectra.published import Floats

SDA_HOURS = 0.5
"""Part of the hours at which a point has enough light by itself."""
ASE_LUX, ASE_HOURS = 1000.0, 250.0
PROVISION = {"EN 17037 target": (300.0, 0.50), "EN 17037 minimum": (100.0, 0.95)}
"""lx, and over which part of the points."""
PROVISION_HOURS, _DAYLIGHT_HOURS = 0.5, 4380.0
_USEFUL = (100.0, 300.0, 3000.0)
_GLARE_BY_LUX, _GLARE_IN_THE_DARK = 6.22e-5, 0.184
"""DGPs = first x vertical illuminance in lx + second (Wienold 2007)."""
_GLARE_LIMITS = (0.35, 0.40, 0.45)
"""Perceptible, disturbing, intolerable (J. Wienold, Building Simulation 2009)."""
MELANOPIC_LUX = 250.0
_SURE = 0.95
GROUPS, GROUPINGS = 8, 4
"""Of batches: with single ones left out, chance would decide which hours cross a limit."""

OfPoint = Callable[[Illuminances], Floats]
"""By point, from illuminances by point and hour."""


@dataclass(frozen=True)
class Estimate:
    """Of each point, or of one number: the figure, its standard error, and of how many degrees of freedom
    that is."""

    value: Floats
    error: Floats
    degrees: int

    def interval(self) -> tuple[Floats, Floats]:
        """Of 95 %."""
        half = stats.t.ppf(0.5 + 0.5 * _SURE, self.degrees) * self.error
        return self.value - half, self.value + half


@dataclass(frozen=True)
class Share:
    """Of points that pass a requirement, each of which may do so by chance."""

    value: float
    low: float
    high: float
    probabilities: Floats
    """By point, that it passes."""

    def at_least(self, part: float) -> float:
        """The probability that at least this part of the points passes."""
        count = len(self.probabilities)
        needed = int(np.ceil(part * count - 1e-9))
        return float(np.clip(_numbers_of(self.probabilities)[needed:].sum(), 0.0, 1.0))


@dataclass(frozen=True)
class Counting:
    """Over which hours of those with light, and by which limit."""

    occupied: NDArray[np.bool_]
    """Of the hours with light, those that count."""
    hours: int
    """All that count, also those without light."""
    lux: float = 300.0
    limits: tuple[float, float, float] = field(default=_USEFUL)

    def figures(self) -> dict[str, OfPoint]:
        """Of a point, by name. Parts of the hours, but for hours and lux hours."""
        low, enough, much = self.limits

        def part(chosen: Callable[[Floats], NDArray[np.bool_]]) -> OfPoint:
            return lambda lit: np.count_nonzero(chosen(self._of(lit.whole)), axis=-1) / self.hours

        unlit = self.hours - int(np.count_nonzero(self.occupied))
        return {
            "DA": part(lambda lux: lux >= self.lux),
            "cDA": lambda lit: np.minimum(self._of(lit.whole) / self.lux, 1.0).sum(axis=-1) / self.hours,
            "UDI below": lambda lit: (
                (np.count_nonzero(self._of(lit.whole) < low, axis=-1) + unlit) / self.hours
            ),
            "UDI supplementary": part(lambda lux: (lux >= low) & (lux < enough)),
            "UDI autonomous": part(lambda lux: (lux >= enough) & (lux <= much)),
            "UDI above": part(lambda lux: lux > much),
            "hours above": lambda lit: np.count_nonzero(self._of(lit.whole) >= self.lux, axis=-1) * 1.0,
            "sun hours": lambda lit: np.count_nonzero(self._of(lit.sun) > ASE_LUX, axis=-1) * 1.0,
            "mean illuminance": lambda lit: self._of(lit.whole).sum(axis=-1) / self.hours,
            **{name: self._provision(lux) for name, (lux, _) in PROVISION.items()},
            "lux hours of the year": lambda lit: lit.whole.sum(axis=-1),
        }

    def eye_figures(self) -> dict[str, OfPoint]:
        """Of a vertical plane at an eye: parts of the hours with simplified DGP above limits, and with the
        Sun in sight, for which DGPs is not made."""

        def above(limit: float) -> OfPoint:
            lux = (limit - _GLARE_IN_THE_DARK) / _GLARE_BY_LUX
            return lambda lit: np.count_nonzero(self._of(lit.whole) > lux, axis=-1) / self.hours

        return {
            **{f"DGPs above {limit:.2f}": above(limit) for limit in _GLARE_LIMITS},
            "Sun in sight": lambda lit: np.count_nonzero(self._of(lit.sun) > 0.0, axis=-1) / self.hours,
            "mean illuminance": lambda lit: self._of(lit.whole).sum(axis=-1) / self.hours,
        }

    def melanopic_figures(self) -> dict[str, OfPoint]:
        """Of melanopic equivalent daylight illuminances."""
        enough = MELANOPIC_LUX
        return {
            "melanopic EDI": lambda lit: self._of(lit.whole).sum(axis=-1) / self.hours,
            f"melanopic EDI of {enough:g} lx": lambda lit: (
                np.count_nonzero(self._of(lit.whole) >= enough, axis=-1) / self.hours
            ),
        }

    def _provision(self, least: float) -> OfPoint:
        """Part of the year's daylight hours, whatever the hours that count elsewhere; more than 1 where days
        are brighter for longer."""
        return lambda lit: np.count_nonzero(lit.whole >= least, axis=-1) / _DAYLIGHT_HOURS

    def _of(self, lux: Floats) -> Floats:
        return np.asarray(lux[..., self.occupied])


def replicates(lit: Illuminances, figures: dict[str, OfPoint]) -> dict[str, Floats]:
    """Each figure by all batches together, and then by all but each group of them, of several groupings:
    shape (1 + groupings x groups, points)."""
    batches = len(lit.whole)
    sums = lit.whole.sum(axis=0), lit.sun.sum(axis=0)
    found: dict[str, list[Floats]] = {name: [] for name in figures}
    for left_out in (np.zeros(0, dtype=int), *groups_of(batches)):
        parts = (sums[0] - lit.whole[left_out].sum(axis=0), sums[1] - lit.sun[left_out].sum(axis=0))
        means = Illuminances(*(each / (batches - len(left_out)) for each in parts))
        for name, figure in figures.items():
            found[name].append(figure(means))
    return {name: np.stack(values) for name, values in found.items()}


def groups_of(batches: int) -> Iterator[NDArray[np.intp]]:
    """Groups of batches, one grouping after the other. Raises ValueError."""
    if batches % GROUPS:
        raise ValueError(f"{batches} batches; expected a multiple of {GROUPS}")
    for grouping in range(GROUPINGS):
        yield from np.random.default_rng(grouping).permutation(batches).reshape(GROUPS, -1)


def jackknife(values: Floats) -> Estimate:
    """From a figure by all, and by all but each group: M. Quenouille, Biometrika 43 (1956) 353; J. Tukey
    1958.

    Noise of single hours moves the number of those above a limit to one side; the part of that which falls as
    one over the number of samples is taken out. The error has a part for how groupings differ in this, and
    one as large as the correction itself: close to a limit, bias falls more slowly than as one over the
    samples.
    """
    by_grouping = values[1:].reshape(GROUPINGS, GROUPS, *values.shape[1:])
    correction = (GROUPS - 1) * (values[0] - values[1:]).mean(axis=0)
    square = (GROUPS - 1) * by_grouping.var(axis=1).mean(axis=0)
    of_correction = (GROUPS - 1) ** 2 * by_grouping.mean(axis=1).var(axis=0, ddof=1) / GROUPINGS
    return Estimate(values[0] + correction, np.sqrt(square + of_correction + correction**2), GROUPS - 1)


def share_of_points(figure: Estimate, limit: float) -> Share:
    """Of those at or above a limit.

    Each point's photons are its own, so points pass independently of each other: where chance may decide,
    the number of those that do has Poisson's binomial distribution.
    """
    distance = figure.value - limit
    sure = figure.error <= 0.0
    z = np.where(sure, 0.0, distance / np.where(sure, 1.0, figure.error))
    passes = np.where(sure, distance >= 0.0, stats.t.cdf(z, figure.degrees))
    below = np.cumsum(_numbers_of(passes))
    count = len(passes)
    value = np.count_nonzero(distance >= 0.0) / count
    low = int(np.searchsorted(below, 0.5 - 0.5 * _SURE, side="right")) / count
    high = int(np.searchsorted(below, 0.5 + 0.5 * _SURE)) / count
    return Share(value, min(low, value), max(high, value), passes)


def _numbers_of(passes: Floats) -> Floats:
    """Probabilities that 0, 1, ... of points pass."""
    found = np.ones(1)
    for each in passes:
        found = np.convolve(found, [1.0 - each, each])
    return found
