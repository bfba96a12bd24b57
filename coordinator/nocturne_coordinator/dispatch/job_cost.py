"""What jobs cost in processor time: how long a range may be, and when a job is stopped. Pure.

docs/decisions/0046: a scene must not hold a worker for long, and only a range that was traced shows how long
the next one will take.
"""

from collections.abc import Iterable
from itertools import pairwise

from nocturne_scene.ranges import FIRST_RANGE

JOB_SECONDS = 60.0
"""Processor seconds that a job should take at most: what a worker that is stopped loses, and others wait."""

USUAL_COST = 1e-6
"""Processor seconds per photon, before anything was measured: what the example scenes cost."""

_CUT_TO = 0.5
"""Part of that to which ranges are cut, so that a somewhat dearer tile does not call for another cut."""

_STOPPED_AT = 10.0
"""Times that, a job is stopped. Tiles are as unlike as a lamp and the sky next to it, machines less so."""

_STOPPED_AT_FIRST = 2.0
"""The same of the first range of a render of which nothing is known."""


def max_cpu_seconds(samples: int, known: bool, job_seconds: float) -> float:
    """Processor seconds after which a job of so many samples per pixel is stopped; `known`: others of its
    render were traced."""
    stopped_at = _STOPPED_AT * job_seconds
    if known:
        return stopped_at
    return min(stopped_at, _STOPPED_AT_FIRST * job_seconds * max(1.0, samples / FIRST_RANGE))


def longest_range(cpu_seconds: float, samples: int, job_seconds: float) -> int | None:
    """Samples to which ranges are to be cut, a power of two, if one of so many samples would take so long;
    None: it may stay as it is."""
    if cpu_seconds <= job_seconds or samples <= FIRST_RANGE:
        return None
    longest = FIRST_RANGE
    while 2 * longest < samples and cpu_seconds / samples * 2 * longest <= _CUT_TO * job_seconds:
        longest *= 2
    return longest


def longest_of(ends: Iterable[int]) -> int:
    """The longest of ranges that end there; 0: there are none."""
    return max((end - first for first, end in pairwise([0, *ends])), default=0)
