"""Random numbers in short decimals, so that a scene that failed can be read."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

T = TypeVar("T")
Point = list[float]


class Chance:
    """A seeded source of choices; the same seed gives the same ones everywhere."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng([seed, 20261129])

    def maybe(self, probability: float) -> bool:
        return bool(self._random.random() < probability)

    def pick(self, choices: Sequence[T]) -> T:
        return choices[int(self._random.integers(len(choices)))]

    def whole(self, low: int, high: int) -> int:
        """Both included."""
        return int(self._random.integers(low, high + 1))

    def number(self, low: float, high: float) -> float:
        return short(float(self._random.uniform(low, high)))

    def factor(self, low: float, high: float) -> float:
        """Between positive numbers, even in the logarithm."""
        return short(float(np.exp(self._random.uniform(np.log(low), np.log(high)))))

    def direction(self) -> Point:
        """Of length 1, about."""
        vector = self._random.normal(size=3)
        return shortened(vector / np.linalg.norm(vector))

    def near(self, centre: Sequence[float], distance: float) -> Point:
        """In a ball."""
        away = float(self._random.random() ** (1.0 / 3.0)) * distance
        return shortened(np.array(centre) + away * np.array(self.direction()))


def short(value: float) -> float:
    return float(f"{value:.4g}")


def shortened(vector: Sequence[float] | np.ndarray) -> Point:
    return [round(float(value), 4) for value in vector]
