"""The service's answers as values: those of the contract, with values derived from them."""

import time

from nocturne_client import contract
from nocturne_client.contract import (
    Explanation,
    Glare,
    GlareSource,
    Group,
    ImportedScene,
    Isolines,
    MeasuredRegions,
    Measurement,
    Measurements,
    NewWebhook,
    Outline,
    PreflightReport,
    Progress,
    Reading,
    ReadValue,
    Region,
    RenderWarning,
    Session,
    StopConditions,
    UnmetPart,
    Usage,
    Webhook,
    Worker,
    WorkOfWorker,
)

__all__ = [
    "Explanation",
    "Glare",
    "GlareSource",
    "Group",
    "ImportedScene",
    "Isolines",
    "MeasuredRegions",
    "Measurement",
    "Measurements",
    "NewWebhook",
    "Outline",
    "PreflightReport",
    "Progress",
    "ReadValue",
    "Reading",
    "Region",
    "Render",
    "RenderWarning",
    "Session",
    "StopConditions",
    "UnmetPart",
    "Usage",
    "Webhook",
    "WorkOfWorker",
    "Worker",
]

_FINAL = frozenset({"SUCCEEDED", "STOPPED_EARLY", "DEGRADED", "FAILED", "CANCELLED"})


class Render(contract.Render):
    """One render, and how far it is."""

    @property
    def has_ended(self) -> bool:
        """Whether the state is final."""
        return self.state in _FINAL

    @property
    def fraction(self) -> float:
        """Samples merged, of all asked for: 0 to 1."""
        return min(1.0, self.progress.mean_samples / self.samples)

    @property
    def seconds_left(self) -> float | None:
        """What its rate and error so far promise; None where there is nothing to go by."""
        end = self.progress.predicted_end
        return None if end <= 0.0 else max(0.0, end - time.time())
