"""Changes that an import made, and parts that it could not carry over."""

from collections.abc import Iterator
from contextlib import contextmanager

from nocturne_scene.errors import InputError, Problem

SHOWN = 50
"""Problems told at once."""

# Of each kind; more of them are counted only.
_KEPT = 1000


class TooLarge(InputError):
    """A scene has more of something than can be left out and forgotten."""

    def __init__(self, message: str, place: str = "") -> None:
        super().__init__((Problem(place, message),))


class Findings:
    """Collects notes and losses. Nothing that a file says is dropped without one of the two."""

    def __init__(self) -> None:
        self._notes: dict[str, None] = {}
        self._lost: dict[Problem, None] = {}
        self._more_notes = 0
        self._more_lost = 0

    def note(self, place: str, message: str) -> None:
        """Note a different form, or a part that does not matter; `place` may be empty."""
        if len(self._notes) < _KEPT:
            self._notes[str(Problem(place, message))] = None
        else:
            self._more_notes += 1

    def lost(self, place: str, message: str) -> None:
        """Report a part without a counterpart here, so that the image will differ."""
        self._lose(Problem(place, message))

    def _lose(self, problem: Problem) -> None:
        if len(self._lost) < _KEPT:
            self._lost[problem] = None
        else:
            self._more_lost += 1

    @property
    def notes(self) -> list[str]:
        """Each once, in the order in which they were made."""
        more = [f"and {self._more_notes:,} notes more"] if self._more_notes else []
        return [*self._notes, *more]

    @property
    def losses(self) -> list[Problem]:
        """Each once, in the order in which they were met."""
        more = [Problem("", f"and {self._more_lost:,} more")] if self._more_lost else []
        return [*self._lost, *more]

    def refuse_losses(self) -> None:
        """Raise InputError with the losses, if there are any."""
        if self._lost:
            raise InputError(self.losses[:SHOWN])

    @contextmanager
    def leaving_out(self) -> Iterator[None]:
        """Go on without a part of the scene that can't be imported: its errors become losses."""
        try:
            yield
        except TooLarge:
            raise
        except InputError as error:
            for problem in error.problems:
                self._lose(problem)
