"""Error bars on trial: distributions whose intervals are known to hold or to fail."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_coordinator.dispatch.heavy_tails import HEAVY, unevenness
from nocturne_scene.pixel_errors import variance_of_mean

Values = npt.NDArray[np.float64]
Draw = Callable[[np.random.Generator, tuple[int, ...]], Values]

_EDGE = 24


def _rare(probability: float) -> Draw:
    """Uniform light and, seldom, a bright photon that carries two thirds of the whole."""
    return lambda random, shape: random.random(shape) + (random.random(shape) < probability) / probability


def _log_normal(sigma: float) -> Draw:
    return lambda random, shape: random.lognormal(0.0, sigma, shape)


def _exponential(random: np.random.Generator, shape: tuple[int, ...]) -> Values:
    return random.exponential(size=shape)


def _pareto(random: np.random.Generator, shape: tuple[int, ...]) -> Values:
    """Of infinite variance: no interval of it is ever right."""
    return random.pareto(1.5, shape) + 1.0


def _image(draw: Draw, samples: int) -> tuple[Values, npt.NDArray[np.uint32]]:
    drawn = draw(np.random.default_rng(samples), (_EDGE, _EDGE, samples))
    y, squares = drawn.sum(axis=-1), (drawn**2).sum(axis=-1)
    return np.stack([y, y, y, squares], axis=-1), np.full((_EDGE, _EDGE), samples, dtype=np.uint32)


def _unevenness(sums: Values, counts: npt.NDArray[np.uint32]) -> float:
    return unevenness(sums[..., 1] / counts, variance_of_mean(sums[..., 1], sums[..., 3], counts))


def _coverage(draw: Draw, samples: int, mean: float) -> float:
    """How often the 95 % interval holds the mean."""
    sums, counts = _image(draw, samples)
    y = sums[..., 1] / samples
    error = np.sqrt((sums[..., 3] / samples - y * y) / (samples - 1))
    assert counts.shape == y.shape
    return float(np.mean(np.abs(y - mean) <= 1.96 * error))


@pytest.mark.parametrize(
    ("draw", "samples", "mean"),
    [
        (_exponential, 64, 1.0),
        (_exponential, 1000, 1.0),
        (_log_normal(1.0), 256, np.exp(0.5)),
        (_rare(1e-1), 256, 1.5),
        (_rare(1e-2), 1000, 1.5),
        (_rare(1e-3), 10000, 1.5),
    ],
)
def test_good_error_bars_are_not_blamed(draw: Draw, samples: int, mean: float) -> None:
    assert _coverage(draw, samples, mean) > 0.9
    assert _unevenness(*_image(draw, samples)) <= HEAVY


@pytest.mark.parametrize(
    ("draw", "samples", "mean"),
    [
        (_log_normal(2.0), 64, np.exp(2.0)),
        (_log_normal(2.0), 1000, np.exp(2.0)),
        (_rare(1e-1), 16, 1.5),
        (_rare(1e-2), 64, 1.5),
        (_rare(1e-3), 1000, 1.5),
        (_pareto, 256, 3.0),
        (_pareto, 4000, 3.0),
    ],
)
def test_heavy_tails_are_told(draw: Draw, samples: int, mean: float) -> None:
    """Coverage as published for log-normals of sigma 2 and rare events: 64 to 90 % instead of 95 %."""
    assert _coverage(draw, samples, mean) < 0.9
    assert _unevenness(*_image(draw, samples)) > HEAVY


def test_what_has_no_noise_has_no_tails() -> None:
    """Black, constant, or a single sample."""
    counts = np.full((4, 4), 8, dtype=np.uint32)
    assert _unevenness(np.zeros((4, 4, 4)), counts) == 0.0
    constant = np.full((4, 4, 4), 8.0)
    assert _unevenness(constant, counts) == 0.0
    assert _unevenness(constant, np.ones((4, 4), dtype=np.uint32)) == 0.0


def test_one_bright_pixel_has_the_variance() -> None:
    """One photon in one pixel of 256, on an image without noise: it is all that there is."""
    counts = np.full((16, 16), 4, dtype=np.uint32)
    sums = np.full((16, 16, 4), 4.0)
    sums[8, 8] += [100.0, 100.0, 100.0, 100.0**2]
    assert _unevenness(sums, counts) == pytest.approx(1.0)


def test_a_lamp_in_the_picture_is_no_tail() -> None:
    """A hundred times brighter and as much noisier: the same relative error everywhere."""
    sums, counts = _image(_exponential, 256)
    sums[:12, :, :3] *= 100.0
    sums[:12, :, 3] *= 100.0**2
    assert _unevenness(sums, counts) <= HEAVY


def test_a_row_of_one_pixel() -> None:
    """There are no neighbours on one side, or none at all."""
    sums, counts = _image(_exponential, 256)
    assert 0.0 < _unevenness(sums[:1], counts[:1]) < HEAVY
    assert _unevenness(sums[:1, :1], counts[:1, :1]) == 0.0
