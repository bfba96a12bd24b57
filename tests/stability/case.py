"""What a torture case is: a small scene whose answer is known."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.accuracy.tracing import Document

RADIANCE_ROUNDING = 2e-5
"""Allowed part of a truth, beyond chance: single precision along a path, and the observer's tables."""


def _no_files(folder: Path) -> None:
    del folder


@dataclass(frozen=True)
class Case:
    """A scene, its true reading, and the allowed deviation."""

    name: str
    stress: str
    """The extreme feature, in a few words."""
    document: Document
    truth: float | None
    """Mean over the film of Y, for lights given as spectral radiance: in units of a flat spectrum's 1; None
    if the only right answer is an error that names the mistake."""
    source: str
    """Where the truth is from."""
    allowed: float = RADIANCE_ROUNDING
    """Allowed part of the truth, beyond chance: how well the truth and the scene that stands for it are
    known."""
    samples: int = 256
    """For each of the 64 pixels."""
    remedy: str = ""
    """What to do where no method is right."""
    files: Callable[[Path], None] = _no_files
    """Writes the files that the document names."""
