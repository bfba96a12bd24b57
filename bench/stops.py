"""Stops by error: how often an image that ended at 5 % is off by more than 10 %, by simulation.

Twenty made-up scenes of which every pixel's distribution is known, so that the truth is: even noise, skewed
sums, heavy tails without a variance, rare bright samples as of caustics, lamps in the picture, black
backgrounds, films of one pixel. Each is drawn many times, range by range, and asked after each range whether
it may end: by the rules of `dispatch/trust.py`, and by the estimate alone (from 16 samples on), as it once
was. Off by more than twice is an image whose root mean square error, or whose mean, is more than 10 % from
the truth, errors measured as the stop measures them.

What no statistics of an image can tell is a light that no sample has met: scenes here have light that a film
of 24 by 24 pixels meets a few times at least before it may end.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from nocturne_coordinator.dispatch.error_estimate import estimate_error
from nocturne_coordinator.dispatch.trust import RangeEnd, confirmed

from bench.report import Figures, Row, significant

Values = npt.NDArray[np.float64]
Random = np.random.Generator

ASKED = 0.05
WRONG = 2.0
"""An error of so many times the target counts as wrong."""

MAX_WRONG_SHARE = 0.05
"""Part of the images that a correct stop may get wrong."""

_EDGE = 24
_LAST = 4096
_LAST_OF_ONE_PIXEL = 65536
_MIN_SAMPLES_ALONE = 16


@dataclass(frozen=True)
class Scene:
    """Pixels whose samples are drawn at will: shape (samples, height, width), and the mean of each."""

    draw: Callable[[Random, int], Values]
    mean: Values


def _film(draw: Callable[[Random, tuple[int, ...]], Values], mean: float, edge: int = _EDGE) -> Scene:
    """All pixels alike."""
    return Scene(lambda random, samples: draw(random, (samples, edge, edge)), np.full((edge, edge), mean))


def _log_normal(sigma: float, edge: int = _EDGE) -> Scene:
    return _film(
        lambda random, shape: random.lognormal(0.0, sigma, shape), float(np.exp(0.5 * sigma**2)), edge
    )


def _pareto(power: float) -> Scene:
    return _film(lambda random, shape: random.pareto(power, shape) + 1.0, power / (power - 1.0))


def _rare(probability: float, light: float = 1.0, even: float = 1.0, edge: int = _EDGE) -> Scene:
    """Light of mean `even` with hardly any noise, which tempts to stop, and, seldom, a bright sample; all of
    those have a mean of `light`."""

    def draw(random: Random, shape: tuple[int, ...]) -> Values:
        bright = (random.random(shape) < probability) * (light / probability)
        values: Values = even * (0.8 + 0.4 * random.random(shape)) + bright
        return values

    return _film(draw, even + light, edge)


def _parts(one: Scene, other: Scene, where: npt.NDArray[np.bool_], scale: float = 1.0) -> Scene:
    """One scene in some pixels, times `scale`, another in the rest."""

    def draw(random: Random, samples: int) -> Values:
        return np.where(where, scale * one.draw(random, samples), other.draw(random, samples))

    return Scene(draw, np.where(where, scale * one.mean, other.mean))


def _scaled(scene: Scene, factors: Values) -> Scene:
    return Scene(lambda random, samples: scene.draw(random, samples) * factors, scene.mean * factors)


def _scenes() -> dict[str, Scene]:
    y, x = np.mgrid[:_EDGE, :_EDGE]
    disc = (x - 11.5) ** 2 + (y - 11.5) ** 2 < 64
    band, lamp = np.abs(x - y) < 2, (x < 4) & (y < 4)
    black = _film(lambda _, shape: np.zeros(shape), 0.0)
    exponential = _film(lambda random, shape: random.exponential(size=shape), 1.0)
    return {
        "even noise": _film(lambda random, shape: 2.0 * random.random(shape), 1.0),
        "exponential": exponential,
        "log-normal, sigma 1": _log_normal(1.0),
        "log-normal, sigma 1.5": _log_normal(1.5),
        "half of the light in one sample of 10000": _rare(1 / 10_000),
        "Pareto, power 3": _pareto(3.0),
        "Pareto, power 2.2": _pareto(2.2),
        "Pareto, power 1.5: no variance": _pareto(1.5),
        "half of the light in one sample of 30": _rare(1 / 30),
        "half of the light in one sample of 300": _rare(1 / 300),
        "half of the light in one sample of 3000": _rare(1 / 3000),
        "a tenth of the light in one sample of 1000": _rare(1 / 1000, 0.1, 0.9),
        "all light in one sample of 1000": _rare(1 / 1000, 1.0, 0.0),
        "a lamp in the picture": _parts(exponential, exponential, lamp, 100.0),
        "a disc before black": _parts(exponential, black, disc),
        "a caustic's band, one sample of 200": _parts(_rare(1 / 200, 5.0), _rare(1.0, 0.0), band),
        "a spectrum on black, one sample of 500": _parts(_rare(1 / 500, 1.0, 0.0), black, band),
        "brightness from 1 to 1000": _scaled(_log_normal(1.0), 10.0 ** (3.0 * x / (_EDGE - 1))),
        "one pixel, log-normal, sigma 1.5": _log_normal(1.5, 1),
        "one pixel, half of the light in one sample of 30": _rare(1 / 30, edge=1),
    }


SCENES = _scenes()


@dataclass
class Ending:
    """Where a render ended by its error, and how far off it was; no samples: it used up all."""

    samples: int = 0
    error: float = 0.0

    @property
    def wrong(self) -> bool:
        return self.error > WRONG * ASKED


def endings(scene: Scene, seed: int) -> tuple[Ending, Ending]:
    """One render: by the rules, and by the estimate alone."""
    random = np.random.default_rng(seed)
    sums = np.zeros((*scene.mean.shape, 4))
    by_rules, alone = Ending(), Ending()
    last = _LAST if scene.mean.size > 1 else _LAST_OF_ONE_PIXEL
    before, samples, end = RangeEnd(), 0, 4
    while end <= last and not (by_rules.samples and alone.samples):
        drawn = scene.draw(random, end - samples)
        sums[..., :3] += drawn.sum(axis=0)[..., None]
        sums[..., 3] += (drawn**2).sum(axis=0)
        samples, end = end, 2 * end
        estimate = estimate_error(sums, np.full(scene.mean.shape, samples, dtype=np.uint32))
        now = RangeEnd.of(estimate)
        if not by_rules.samples and confirmed(before, now, ASKED):
            by_rules = Ending(samples, _off_by(sums[..., 1] / samples, scene.mean))
        met = samples >= _MIN_SAMPLES_ALONE and 0.0 < estimate.relative_error <= ASKED
        if met and not alone.samples:
            alone = Ending(samples, _off_by(sums[..., 1] / samples, scene.mean))
        before = now
    return by_rules, alone


def _off_by(y: Values, truth: Values) -> float:
    level = float(np.mean(truth))
    pixels = np.sqrt(np.mean((y - truth) ** 2 / (truth**2 + 0.01 * level**2)))
    return max(float(pixels), abs(float(np.mean(y)) - level) / level)


def run(quick: bool) -> Figures:
    """For each scene: renders that ended by their error, those off by more than twice, by both rules."""
    renders = 10 if quick else 1000 if os.environ.get("BENCH") == "full" else 200
    figures: Figures = {"renders": renders}
    for number, (name, scene) in enumerate(SCENES.items()):
        both = [endings(scene, 10_000 * number + seed) for seed in range(renders)]
        figures[name] = {
            "rules": _counted([each[0] for each in both]),
            "estimate alone": _counted([each[1] for each in both]),
        }
    return figures


def _counted(found: list[Ending]) -> Figures:
    ended = [each for each in found if each.samples]
    return {
        "ended": len(ended),
        "wrong": sum(each.wrong for each in ended),
        "samples": significant(float(np.median([each.samples for each in ended]))) if ended else 0,
    }


def wrong_share(figures: Figures, rule: str) -> float:
    """Of all images that ended by their error, those that are off by more than twice."""
    ended = sum(int(figures[name][rule]["ended"]) for name in SCENES)
    return sum(int(figures[name][rule]["wrong"]) for name in SCENES) / max(1, ended)


def rows(figures: Figures) -> list[Row]:
    """A line for each scene, and the whole."""
    table = []
    for name in SCENES:
        found = figures[name]
        told = "; ".join(
            f"{rule}: {found[rule]['ended']} ended, {found[rule]['wrong']} wrong, "
            f"median {found[rule]['samples']:g} samples"
            for rule in ("rules", "estimate alone")
        )
        table.append(Row(f"{name}: of {figures['renders']} renders", told))
    shares = (
        f"rules {100 * wrong_share(figures, 'rules'):.3g} %, "
        f"estimate alone {100 * wrong_share(figures, 'estimate alone'):.3g} %"
    )
    aim = f"rules below {100 * MAX_WRONG_SHARE:g} %"
    table.append(Row("of all images that ended at 5 %, off by more than 10 %", shares, aim))
    return table
