"""A render of the contract, with values derived from it."""

import time

from nocturne_client import contract

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
