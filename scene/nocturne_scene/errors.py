"""Every exception that leaves this package. Readers of files have others, which become problems with a place.

NocturneError
+-- InputError      what the user gave is wrong; each problem names its place
    +-- Incomplete  (`formats.import_scene`) a scene was imported, and something in it has no counterpart here
+-- NotFound        there is no such file, or render
+-- PilotFailed     the small renders of a preflight can't be made, or have nothing to compare
"""

from collections.abc import Iterable
from dataclasses import dataclass


class NocturneError(Exception):
    """Base of all errors raised on purpose; `str()` is fit to be shown to a user."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing wrong with an input: where (`$.surfaces[3].kernel`), and what, with the valid choices."""

    place: str
    message: str

    def __str__(self) -> str:
        return f"{self.place}: {self.message}" if self.place else self.message


class InputError(NocturneError):
    """The input can't be used; holds at least one problem."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = tuple(problems)
        if not self.problems:
            raise ValueError("an InputError needs at least one problem")
        super().__init__("; ".join(str(problem) for problem in self.problems))

    @classmethod
    def at(cls, place: str, message: str) -> "InputError":
        """An error of one problem."""
        return cls([Problem(place, message)])


class NotFound(NocturneError):
    """There is no such render or blob."""


class PilotFailed(NocturneError):
    """The pilot of a preflight can't be run, or has nothing to compare."""
