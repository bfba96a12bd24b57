"""What a model costs for a target, and which one is cheapest. Pure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, inf, sqrt
from typing import Literal

from nocturne_scene.simplify.simplification import Simplification
from nocturne_scene.simplify.statistics import UNBIASED, Bias, Interval

Need = Literal["needed", "not needed", "undecided", "same image"]

_WORTH = 0.95
"""A simplification that leaves more of the time than this is not worth a simpler scene."""

_SAME = Interval(1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Model:
    """A model of the scene as a pilot has measured it; without parts it is the full one."""

    parts: tuple[Simplification, ...]
    bias: Bias
    """As measured; of the full model against itself, nothing."""
    noise: float
    """Squared relative error of one sample per pixel; falls as 1 / samples."""
    seconds: float
    """Processor time of one sample of one pixel."""
    cost: Interval = _SAME
    """`seconds` over the full model's."""

    @property
    def name(self) -> str:
        return ", ".join(part.name for part in self.parts) or "the full model"

    @property
    def exact(self) -> bool:
        """Whether it makes the same image by theory, so that its measured bias is chance."""
        return all(part.exact for part in self.parts)

    @property
    def believed_bias(self) -> Bias:
        """As measured, but none where theory says none."""
        return UNBIASED if self.exact else self.bias

    def samples_for(self, error: float) -> float:
        """Samples per pixel after which bias, as large as its intervals allow, and noise are together within
        `error`; inf if the bias alone is not."""
        left = error**2 - self.believed_bias.largest**2
        return max(2.0, ceil(self.noise / left)) if left > 0 else inf

    def seconds_for(self, error: float, pixels: int) -> float:
        """The same as processor time of a film."""
        return self.samples_for(error) * self.seconds * pixels

    def error_after(self, seconds: float, pixels: int) -> float:
        """Total error after some processor time, with the bias as estimated."""
        return sqrt(self.believed_bias.local.value**2 + self.noise * self.seconds * pixels / seconds)


def verdict(model: Model, error: float) -> Need:
    """Whether a target needs what the model does without."""
    if model.exact:
        return "same image"
    bias = model.bias
    if bias.largest <= error:
        return "not needed"
    surely_off = bias.local.low > error or bias.mean.low > error or bias.mean.high < -error
    return "needed" if surely_off else "undecided"


def promising(models: Sequence[Model], full: Model, error: float) -> list[Model]:
    """Models that meet the target in clearly less time than the full one, the fastest first."""
    found = [each for each in models if worth_more(each, full, error)]
    return sorted(found, key=lambda each: each.samples_for(error) * each.cost.value)


def worth_more(model: Model, than: Model, error: float) -> bool:
    """Whether a model meets the target in clearly less time than another.

    Times are taken relative to the full model's, which was rendered in turn with each: the machine's other
    work is in both. The upper end counts.
    """
    return model.samples_for(error) * model.cost.high < _WORTH * than.samples_for(error) * than.cost.value


def saving(full: Model, model: Model, error: float) -> float:
    """The full model's time to the target over another's; 0 if that does not reach it."""
    return full.samples_for(error) / (model.samples_for(error) * model.cost.value)


def can_join(parts: Sequence[Simplification], more: Simplification) -> bool:
    """Whether a simplification makes sense on top of others."""
    return not more.kind or more.kind not in (part.kind for part in parts)


def budgets(models: Sequence[Model], error: float, pixels: int, count: int) -> Iterator[float]:
    """Processor times for a chart, in equal ratios: from noise of four targets to noise of a quarter."""
    # One sample at least: some scenes have no noise.
    times = [max(each.noise / error**2, 1.0) * each.seconds * pixels for each in models]
    low, high = min(times) / 16, max(times) * 16
    for index in range(count):
        yield low * (high / low) ** (index / (count - 1))
