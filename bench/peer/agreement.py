"""Whether two renderers' pictures differ by more than their noise."""

from dataclasses import dataclass

import numpy as np

from bench.errors import true_relmse
from bench.programs import Channel
from bench.report import Figures, significant


@dataclass(frozen=True)
class Reference:
    """A mean of independent frames, and its standard error by pixel, found from how the frames differ."""

    y: Channel
    error: Channel

    @staticmethod
    def of(frames: list[Channel]) -> "Reference":
        """At least two frames; whatever the sampler, they only must be independent of each other."""
        stack = np.stack(frames)
        return Reference(np.mean(stack, axis=0), np.std(stack, axis=0, ddof=1) / np.sqrt(len(frames)))


def agreement(ours: Reference, theirs: Reference) -> Figures:
    """Ratio of the mean luminances with its standard error; then the pixels, theirs scaled by that ratio.

    z is a difference over its standard error: mean 0 and root mean square a little more than 1 if both are
    right (the standard errors are themselves estimates). `difference` is the root of the relMSE that is left
    when the noise's share is taken off.
    """
    ratio = float(np.mean(ours.y) / np.mean(theirs.y))
    relative = [np.sqrt(np.sum(each.error**2)) / np.sum(each.y) for each in (ours, theirs)]
    error = np.sqrt(ours.error**2 + (ratio * theirs.error) ** 2)
    difference = ours.y - ratio * theirs.y
    z = np.divide(difference, error, out=np.zeros_like(error), where=error > 0)
    left = true_relmse(ratio * theirs.y, ours.y, error)
    return {
        "ratio": round(ratio, 6),
        "ratio_error": significant(ratio * float(np.hypot(*relative))),
        "mean_z": significant(float(np.mean(z))),
        "rms_z": significant(float(np.sqrt(np.mean(z**2)))),
        "beyond_3": significant(float(np.mean(np.abs(z) > 3))),
        "difference": significant(float(np.sqrt(max(left, 0.0)))),
    }
