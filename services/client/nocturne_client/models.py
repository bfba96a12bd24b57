"""What the service says, as values."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

_FINAL = frozenset({"SUCCEEDED", "FAILED", "CANCELLED"})


@dataclass(frozen=True)
class Progress:
    """What has been merged and committed of a render."""

    ranges_done: int
    ranges_planned: int
    photons: int
    rays: int
    rejected: int
    mean_samples: float
    """Mean over pixels of samples merged."""
    relative_error: float
    """Standard error of Y, root mean square over pixels, relative to the mean Y; 0 where unknown."""
    photons_per_second: float
    cpu_seconds: float

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> Self:
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


@dataclass(frozen=True)
class Render:
    """One render; times are unix seconds, 0 where it has not happened."""

    id: str
    name: str
    state: str
    """QUEUED, RUNNING, SUCCEEDED, FAILED or CANCELLED."""
    reason: str
    width: int
    height: int
    samples: int
    scene_sha256: str
    sequence: int
    created: float
    started: float
    ended: float
    progress: Progress

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
        """What the present rate promises; None where there is none."""
        rate = self.progress.photons_per_second
        photons_left = self.samples * self.width * self.height - self.progress.photons
        return None if rate <= 0 else max(0.0, photons_left / rate)

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> Self:
        """From the service's JSON; fields of later versions are left out."""
        return cls(**{**_known(cls, value), "progress": Progress.from_json(value["progress"])})


@dataclass(frozen=True)
class Worker:
    """One worker process."""

    id: str
    engine: int
    threads: int
    photons_per_second: float
    jobs_done: int
    started: float

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> Self:
        """From the service's JSON; fields of later versions are left out."""
        return cls(**_known(cls, value))


def _known(model: type[Any], value: Mapping[str, Any]) -> dict[str, Any]:
    return {field.name: value[field.name] for field in fields(model)}
