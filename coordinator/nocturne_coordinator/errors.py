"""Every exception that this package raises on purpose.

NocturneError
+-- InputError      what the user gave is wrong; each problem names its place
+-- NotFound        there is no such render or blob
+-- Conflict        a request id was used before with other content
+-- FilesGone       files of a scene were deleted after it was compiled
+-- WrongState      the render is in a state in which that can't be done
+-- AlreadyOwned    another coordinator works on the data folder
+-- QueueTaken      Redis serves the coordinator of another data folder
+-- OwnershipLost   another coordinator took the data folder over; nothing may be committed any more
+-- LeaseLost       another coordinator has the render, or its sums were changed; nothing of it may be written
+-- UnusableFolder  the folder was written by another version, or is damaged
+-- CantRestore     there is nothing whole to restore from
+-- UnusableQueue   Redis is set up in a way that loses messages
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Self


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


class Conflict(NocturneError):
    """The request id was used before, with other content."""


class FilesGone(NocturneError):
    """Files of a scene were deleted with another render after it was compiled; compiling again may help."""


class WrongState(NocturneError):
    """The render is in a state in which that can't be done."""


class QueueTaken(NocturneError):
    """Redis serves the coordinator of another data folder."""


class AlreadyOwned(NocturneError):
    """Another coordinator works on the data folder."""


class OwnershipLost(NocturneError):
    """Another coordinator took the data folder over; this one must stop without committing."""


class LeaseLost(NocturneError):
    """Another coordinator has the render, or its sums were changed; what is in memory of it is of no use."""

    def __init__(self, render_id: str) -> None:
        super().__init__(f"{render_id} is not this coordinator's any more")
        self.render_id = render_id


class UnusableFolder(NocturneError):
    """The data folder was written by another version of the program, is damaged, or can't be written."""

    @classmethod
    def because(cls, folder: Path, trouble: Exception) -> Self:
        """What the system or SQLite says that passes: no rights, no space, another file in its place."""
        return cls(f"{folder} can't be used ({trouble}); see to its rights and to the space on its disk")


class CantRestore(NocturneError):
    """There is nothing whole to restore a data folder from, or nothing that may be replaced."""


class UnusableQueue(NocturneError):
    """Redis is set up in a way that loses messages."""
