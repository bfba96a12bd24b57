"""The one exception of this package."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a request: where (`$.surfaces[3].kernel`), and what."""

    place: str
    message: str

    def __str__(self) -> str:
        return f"{self.place}: {self.message}" if self.place else self.message


class NocturneClientError(Exception):
    """A request that did not succeed; `problems` says what to change."""

    def __init__(
        self, message: str, status: int = 0, problems: Sequence[Problem] = (), retry_after_s: float = 0.0
    ) -> None:
        """`status`: of the HTTP answer, 0 where there was none; `retry_after_s`: as its Retry-After."""
        super().__init__(message)
        self.status = status
        self.problems = tuple(problems)
        self.retry_after_s = retry_after_s

    @property
    def can_be_retried(self) -> bool:
        """Whether the same request may succeed later."""
        return self.status in (429, 503)


class NotReachedError(NocturneClientError):
    """The service did not answer, or the connection was lost."""

    @property
    def can_be_retried(self) -> bool:
        return True
