"""Renderers in turns at equal budgets of processor time, and the references that judge them."""

from collections.abc import Mapping

from bench.peer.agreement import Reference
from bench.peer.contenders import Contender, Frame

OURS = "nocturne"

THREADS = 2
"""As many for each renderer as the machines that we measure on have."""

# Seeds: of references, and of the first guess at the cost; frames that are measured begin at 0.
_REFERENCE_SEED, _TRIAL_SEED = 10_000, 20_000


def rate(contender: Contender, samples: int) -> float:
    """CPU seconds of a sample in each pixel, by a trial with so many."""
    return contender.frame(samples, _TRIAL_SEED).cpu_s / samples


def in_turns(
    contenders: Mapping[tuple[str, float], tuple[Contender, int]], rounds: int
) -> dict[tuple[str, float], list[Frame]]:
    """Frames of each, which are given by name and budget with their numbers of samples."""
    frames: dict[tuple[str, float], list[Frame]] = {key: [] for key in contenders}
    for seed in range(rounds):
        for key, (contender, samples) in contenders.items():
            frames[key].append(contender.frame(samples, seed))
    return frames


def reference(contender: Contender, samples: int, frames: int) -> Reference:
    """A renderer's own truth, so that a difference between two renderers is disagreement and not noise."""
    return Reference.of([contender.frame(samples, _REFERENCE_SEED + number).y for number in range(frames)])
