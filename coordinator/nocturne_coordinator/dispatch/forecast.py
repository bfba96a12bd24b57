"""Forecast of a render's end and cost, from its measured rate and error. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.dispatch.trust import RangeEnd, samples_to_stop

_FIRST_SECONDS = 10.0
"""Of running, before anything is said of a miss: the time over which the rate is counted."""

_FIRST_PART = 0.1
"""The same for renders that may run for less than a hundred seconds, as a part of these."""

_CLEARLY = 1.1
"""A miss is reported from so many times the available time, and taken back where that time is enough: rates
vary by some percent from one second to the next."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Where a render stands."""

    photons: int
    photons_wanted: float
    """Until the last sample, or until all tiles are expected to have met their error."""
    mean_samples: float
    estimate: ErrorEstimate
    range_ends: Sequence[int]
    photons_per_second: float
    cpu_seconds: float
    ran_seconds: float
    """Time running, pauses left out."""


@dataclass(frozen=True, slots=True)
class Forecast:
    """0: nothing to go by yet."""

    end: float = 0.0
    """Unix time."""
    cpu_seconds: float = 0.0
    """The total, with the cost so far included."""
    target_unreachable: str = ""
    """Why the error asked for will not be reached in time, a sentence; empty: it will, or who knows."""


UNKNOWN = Forecast()


def forecast(measured: Measured, stop: StopConditions, now: float, was_unreachable: bool = False) -> Forecast:
    """What the first condition to be met promises at `now`, unix time.

    The error is taken to fall as one over the root of the samples: the law of independent samples. Scrambled
    Sobol samples do a little better, so the forecast is on the safe side. `was_unreachable`: by the forecast
    before this one.
    """
    if measured.photons <= 0 or measured.photons_per_second <= 0.0:
        return UNKNOWN
    cpu_rate = measured.cpu_seconds / measured.photons * measured.photons_per_second
    last = (measured.photons_wanted - measured.photons) / measured.photons_per_second
    times = _times_left(measured, stop, now, cpu_rate)
    left = max(0.0, min(last, _error_seconds(measured, stop), *times))
    if not math.isfinite(left):
        return UNKNOWN
    miss = _miss(measured, stop, times, last, was_unreachable) if stop.relative_error else ""
    return Forecast(now + left, measured.cpu_seconds + left * cpu_rate, miss)


def _error_seconds(measured: Measured, stop: StopConditions) -> float:
    """Until a stop by error is expected; infinite: never, or not asked for."""
    if not (stop.relative_error and measured.estimate.relative_error and measured.mean_samples):
        return math.inf
    needed = samples_to_stop(
        measured.estimate, measured.mean_samples, stop.relative_error, measured.range_ends
    )
    return measured.photons * (needed / measured.mean_samples - 1.0) / measured.photons_per_second


def _times_left(measured: Measured, stop: StopConditions, now: float, cpu_rate: float) -> dict[float, str]:
    """Seconds until each time that was asked for ends the render, and what happens then in words."""
    times = {}
    if stop.wall_seconds:
        times[stop.wall_seconds - measured.ran_seconds] = f"stops after {stop.wall_seconds:g} s of running"
    if stop.until:
        times[stop.until - now] = f"stops at {stop.until_text or 'the time asked for'}"
    if stop.cpu_seconds and cpu_rate > 0.0:
        seconds = (stop.cpu_seconds - measured.cpu_seconds) / cpu_rate
        times[seconds] = f"has used {stop.cpu_seconds:g} s of processor time"
    return times


def _miss(
    measured: Measured, stop: StopConditions, times: dict[float, str], last: float, was_missed: bool
) -> str:
    """By how much the error that was asked for is missed when a time ends the render; empty: it is not."""
    error = RangeEnd.of(measured.estimate).error or measured.estimate.relative_error
    if not times or error <= 0.0:
        return ""
    left = max(0.0, min(times))
    ran, allowed = measured.ran_seconds, measured.ran_seconds + left
    if ran < min(_FIRST_SECONDS, _FIRST_PART * allowed):
        return ""
    # By the law alone: the render stops at the end of a range, which comes later.
    needed = (error / stop.relative_error) ** 2 * measured.photons
    seconds = (needed - measured.photons) / measured.photons_per_second
    if min(left, last) * (1.0 if was_missed else _CLEARLY) >= seconds:
        return ""
    ends = min(left, last)
    photons = measured.photons + ends * measured.photons_per_second
    reached = error * math.sqrt(measured.photons / photons)
    what = times[min(times)] if left <= last else "has taken its last sample"
    times_longer = (ran + seconds) / max(1e-9, ran + ends)
    return (
        f"It will have a relative error of about {100 * reached:.2g} % when it {what}; "
        f"{100 * stop.relative_error:.3g} % was asked for, which would take "
        f"{times_longer:,.{1 if times_longer < 100 else 0}f} times as long at this rate."
    )
