"""What an import changed, and what it could not carry over."""

from collections.abc import Iterator
from contextlib import contextmanager

from nocturne_scene.errors import InputError, Problem

SHOWN = 50
"""Problems told at once."""


class Findings:
    """Collects notes and losses. Nothing that a file says is dropped without one of the two."""

    def __init__(self) -> None:
        self._notes: dict[str, None] = {}
        self._lost: dict[Problem, None] = {}

    def note(self, place: str, message: str) -> None:
        """Something is expressed in another way, or does not matter; `place` may be empty."""
        self._notes[str(Problem(place, message))] = None

    def lost(self, place: str, message: str) -> None:
        """Something has no equal here, so that the image will differ."""
        self._lost[Problem(place, message)] = None

    @property
    def notes(self) -> list[str]:
        """Each once, in the order in which they were made."""
        return list(self._notes)

    @property
    def losses(self) -> list[Problem]:
        """Each once, in the order in which they were met."""
        return list(self._lost)

    def refuse_losses(self) -> None:
        """Raise InputError with what was lost, if anything was."""
        if self._lost:
            raise InputError(self.losses[:SHOWN])

    @contextmanager
    def leaving_out(self) -> Iterator[None]:
        """Go on without a part of the scene that can't be imported: its errors become losses."""
        try:
            yield
        except InputError as error:
            self._lost |= dict.fromkeys(error.problems)
