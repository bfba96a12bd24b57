"""What the service says, as values."""

import time
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any

_FINAL = frozenset({"SUCCEEDED", "STOPPED_EARLY", "DEGRADED", "FAILED", "CANCELLED"})


@dataclass(frozen=True)
class Progress:
    """What has been merged and committed of a render."""

    ranges_done: int
    ranges_planned: int
    photons: int
    rays: int
    invalid_samples: int
    mean_samples: float
    """Mean over pixels of samples merged."""
    relative_error: float
    """Standard error of Y, root mean square over pixels, relative to the mean Y; 0 where unknown."""
    photons_per_second: float
    cpu_seconds: float
    tiles_done: int
    """Tiles that need no more samples."""
    tiles: int
    tiles_failed: int
    """Tiles left as they are, after failing on several workers."""
    audited: int
    """Ranges that were traced again elsewhere, and were the same."""
    refused: int
    """Results that could not be right."""
    predicted_end: float
    """Unix time; 0 unknown."""
    predicted_cpu_seconds: float
    """In all; 0 unknown."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "Progress":
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


@dataclass(frozen=True)
class Stop:
    """When a render ends besides at its last sample; 0 or empty: not asked for."""

    relative_error: float
    tile_relative_error: float
    wall_seconds: float
    cpu_seconds: float
    until: str
    until_time: float
    """Unix time."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "Stop":
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


@dataclass(frozen=True)
class Render:
    """One render; times are unix seconds, 0 where it has not happened."""

    id: str
    name: str
    state: str
    """QUEUED, RUNNING, PAUSED, SUCCEEDED, STOPPED_EARLY, DEGRADED, FAILED or CANCELLED."""
    reason: str
    width: int
    height: int
    samples: int
    scene_sha256: str
    sequence: int
    created: float
    started: float
    ended: float
    stop: Stop
    priority: int
    owner: str
    progress: Progress
    floating_point_profile: str = ""
    """How its workers round; empty before the first result."""

    @property
    def has_ended(self) -> bool:
        """Whether the state is final."""
        return self.state in _FINAL

    @property
    def fraction(self) -> float:
        """Photons merged, of all asked for: 0 to 1."""
        return min(1.0, self.progress.mean_samples / self.samples)

    @property
    def seconds_left(self) -> float | None:
        """What its rate and error so far promise; None where there is nothing to go by."""
        end = self.progress.predicted_end
        return None if end <= 0.0 else max(0.0, end - time.time())

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "Render":
        """From the service's JSON; fields of later versions are left out."""
        parts = {"progress": Progress.from_json(value["progress"]), "stop": Stop.from_json(value["stop"])}
        return cls(**{**_known(cls, value), **parts})


@dataclass(frozen=True)
class Worker:
    """One worker process."""

    id: str
    engine: int
    threads: int
    photons_per_second: float
    jobs_done: int
    started: float
    quarantine: str
    """Why its results are not taken; empty: they are."""
    floating_point_profile: str = ""
    """A name for how it rounds: a render takes results of one class only."""
    incompatible: str = ""
    """Why it gets no jobs though it is not in quarantine; empty: it gets them."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "Worker":
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


@dataclass(frozen=True)
class Webhook:
    """An address that is told how renders end."""

    id: str
    owner: str
    url: str
    created: float
    last_outcome: str
    """How the last message went; empty before the first."""
    secret: str = ""
    """What messages are signed with; known only when it is made."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> "Webhook":
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


def _known(model: type[Any], value: Mapping[str, Any]) -> dict[str, Any]:
    # What has a default came with a later version of the service than its first.
    return {
        field.name: value[field.name]
        for field in fields(model)
        if field.default is MISSING or field.name in value
    }
