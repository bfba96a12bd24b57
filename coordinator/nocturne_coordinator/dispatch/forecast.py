"""When a render will end and what it will have cost, from its measured rate and error. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.dispatch.trust import samples_to_stop


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
    """In all, what is spent included."""


UNKNOWN = Forecast()


def forecast(measured: Measured, stop: StopConditions, now: float) -> Forecast:
    """What the first condition to be met promises at `now`, unix time.

    The error is taken to fall as one over the root of the samples: the law of independent samples. Scrambled
    Sobol samples do a little better, so the forecast is on the safe side.
    """
    if measured.photons <= 0 or measured.photons_per_second <= 0.0:
        return UNKNOWN
    cpu_per_photon = measured.cpu_seconds / measured.photons
    cpu_rate = cpu_per_photon * measured.photons_per_second
    photons = measured.photons_wanted
    if stop.relative_error and measured.estimate.relative_error and measured.mean_samples:
        needed = samples_to_stop(
            measured.estimate, measured.mean_samples, stop.relative_error, measured.range_ends
        )
        photons = min(photons, measured.photons * needed / measured.mean_samples)
    seconds = [(photons - measured.photons) / measured.photons_per_second]
    if stop.wall_seconds:
        seconds.append(stop.wall_seconds - measured.ran_seconds)
    if stop.until:
        seconds.append(stop.until - now)
    if stop.cpu_seconds and cpu_rate > 0.0:
        seconds.append((stop.cpu_seconds - measured.cpu_seconds) / cpu_rate)
    left = max(0.0, min(seconds))
    if not math.isfinite(left):
        return UNKNOWN
    return Forecast(now + left, measured.cpu_seconds + left * cpu_rate)
