"""How far a simpler model's image is from the full one's, and how noisy it is; from repeated renders. Pure.

The full model and a simpler one are rendered R times each, the r-th time with the same seed, the R seeds
being independent. Only the independence of the R pairs is used: common seeds make the differences less noisy
where photons take the same paths, and do no harm where they don't.

All errors are relative as in the stop condition `relative error`: squares over F^2 + 0.01 M^2, where
F is a pixel of the full model's image and M its mean.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

Values = NDArray[np.float64]

LEVEL = 0.01
"""Part of the squared mean by which dark pixels are levelled."""

FEWEST = 4
"""Renders of a model: two for a pair, one for what that pair is relative to, and one to be left out."""


@dataclass(frozen=True)
class Interval:
    """An estimate, and where the truth lies with the asked confidence."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Bias:
    """How a model's image differs from the full model's when the noise is gone."""

    mean: Interval
    """Of the mean luminance, relative to the full model's; with sign."""
    local: Interval
    """Root of the mean over pixels of the squared relative difference; never negative."""

    @property
    def largest(self) -> float:
        """The largest bias, with the confidence of the intervals."""
        return max(self.local.high, abs(self.mean.low), abs(self.mean.high))


FEW = 50.0
"""Effective sample size of pixels (Kish) below which their sums are not near a normal distribution."""

UNBIASED = Bias(Interval(0.0, 0.0, 0.0), Interval(0.0, 0.0, 0.0))


def bias(full: Values, simple: Values, confidence: float) -> Bias:
    """Of renders of shape (R, pixels), R >= FEWEST; row r of both has the same seed.

    Each interval holds the truth with `confidence` in (0, 1), as far as R renders of independent seeds are
    near enough to a normal distribution; pixels that live on rare bright photons are not.
    """
    count = _checked(full, simple)
    if not full.any():
        raise ValueError("the full model's image is black")
    student = float(special.stdtrit(count - 1, 0.5 + 0.5 * confidence))
    means, others = full.mean(axis=1), simple.mean(axis=1)
    ratio = float(others.mean() / means.mean())
    # Of a ratio of means, to first order: W. G. Cochran, Sampling Techniques, 1977, section 2.11.
    spread = others - ratio * means
    error = float(np.sqrt(np.sum(spread**2) / (count - 1) / count) / abs(means.mean()))
    mean = Interval(ratio - 1, ratio - 1 - student * error, ratio - 1 + student * error)
    square = _squared_difference(full, simple, student)
    root = Interval(*(float(np.sqrt(max(0.0, each))) for each in (square.value, square.low, square.high)))
    return Bias(mean, root)


def _squared_difference(full: Values, simple: Values, student: float) -> Interval:
    """Mean over pixels of the squared difference of expectations, relative. Unbiased by noise.

    Products of differences of two different renders have the square of their expectation as expectation. The
    mean over all pairs is a U-statistic, and the jackknife over renders gives its variance, rather too large
    than too small (J. N. Arvesen, Annals of Mathematical Statistics 40, 1969; B. Efron and C. Stein, Annals
    of Statistics 9, 1981).
    """
    count = full.shape[0]
    value = _mean_of_pairs(full, simple)
    without = np.array(
        [
            _mean_of_pairs(full[keep], simple[keep])
            for keep in ([each for each in range(count) if each != left_out] for left_out in range(count))
        ]
    )
    error = np.sqrt((count - 1) / count * np.sum((without - without.mean()) ** 2))
    return Interval(value, float(value - student * error), float(value + student * error))


def _mean_of_pairs(full: Values, simple: Values) -> float:
    difference = simple - full
    products = [np.mean(difference[one] * difference[other] / scale) for one, other, scale in _pairs(full)]
    return float(np.mean(products))


def noise(full: Values, simple: Values) -> float:
    """The model's squared relative error of one render; shapes as in `bias`.

    It goes down as 1 / samples; with Sobol points somewhat faster.
    """
    _checked(full, simple)
    squares = [np.mean((simple[one] - simple[other]) ** 2 / scale) for one, other, scale in _pairs(full)]
    return 0.5 * float(np.mean(squares))


def effective_pixels(full: Values) -> float:
    """How many pixels carry the noise: its sum's square over the sum of squares. Shape as in `bias`.

    Single pixels may have heavy tails as long as many do; where few carry the noise, intervals of sums do not
    hold, and in other renders it is others.
    """
    _checked(full, full)
    shares = np.sum([(full[one] - full[other]) ** 2 / scale for one, other, scale in _pairs(full)], axis=0)
    squares = float(np.sum(shares**2))
    return float(np.sum(shares)) ** 2 / squares if squares > 0 else float(full.shape[1])


def _pairs(full: Values) -> Iterator[tuple[int, int, Values]]:
    """All pairs of renders, and what their products are relative to, shape (pixels,): the image of the other
    renders. A pixel that is bright by chance does not hide its own noise so."""
    count, total = full.shape[0], full.sum(axis=0)
    for one in range(count):
        for other in range(one):
            rest = (total - full[one] - full[other]) / (count - 2)
            scale = rest**2 + LEVEL * np.mean(rest) ** 2
            yield one, other, np.maximum(scale, np.finfo(float).tiny)


def ratio_of_costs(full: Values, simple: Values, confidence: float) -> Interval:
    """Processor time of the simpler model over the full one's; shape (R,), rendered in turn."""
    logs = np.log(simple / full)
    student = special.stdtrit(len(logs) - 1, 0.5 + 0.5 * confidence)
    error = float(student * logs.std(ddof=1) / np.sqrt(len(logs)))
    middle = float(logs.mean())
    low, high = np.exp(middle - error), np.exp(middle + error)
    return Interval(float(np.exp(middle)), float(low), float(high))


def resolvable(noise_of_render: float, renders: int, pixels: int, confidence: float) -> float:
    """The local bias that an interval's end shows where there is none, if the models' noise is independent.

    `noise_of_render` as `noise` gives it; of two models, twice. By the variance of a U-statistic of pairs,
    2 / (R (R - 1)) of the squared variance of a difference, over the pixels.
    """
    student = float(special.stdtrit(renders - 1, 0.5 + 0.5 * confidence))
    return float(np.sqrt(student * np.sqrt(2 / (renders * (renders - 1) * pixels)) * 2 * noise_of_render))


def _checked(full: Values, simple: Values) -> int:
    if full.shape != simple.shape or full.ndim != 2 or full.shape[0] < FEWEST:
        raise ValueError(f"expected two of the same shape (renders, pixels), at least {FEWEST} renders")
    return int(full.shape[0])
