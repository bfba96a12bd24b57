"""From measured pixels to a word: right, noisy, biased, refused."""

from dataclasses import dataclass
from enum import Enum

from tests.accuracy.agreement import Values, student_bound

CELLS = 600
"""At least as many as the matrix has: the bound on |z| is for all of them together, false alarms 0.01."""

NOISY = 0.02
"""A standard error above this part of the truth shows little."""

HEAVY = 0.25
"""Part of the sum that one pixel of 64 may have; above it, error bars are not to be trusted."""


UNEVEN = 3.0
"""Times their own standard errors that pixels may scatter."""


class Word(Enum):
    """The kinds of outcome."""

    RIGHT = "right"
    NOISY = "noisy"
    BIASED = "biased"
    UNEVEN = "uneven"
    """Pixels that should measure the same differ by far more than their error bars."""
    NOTHING = "found nothing"
    """No photon met any light, though there is some."""
    REFUSED = "refused"
    ACCEPTED = "accepted"
    """What should have been refused."""
    FAILED = "failed"
    """A crash, a time limit, or photons that were not finite."""
    NOT_APPLICABLE = "-"


@dataclass(frozen=True)
class Verdict:
    """The outcome of a case by a method."""

    word: Word
    off: float | None = None
    """Mean over truth, minus 1; the mean itself where the truth is 0."""
    error: float | None = None
    """Standard error of `off`."""
    said: str = ""
    """The message of a refusal, or the reason of a failure."""
    cpu_s: float = 0.0
    warned: bool = False
    """Whether compiling told of something that can hardly be meant."""

    @property
    def good(self) -> bool:
        """Whether nothing is wrong with it; noise is not wrong."""
        return self.word in (Word.RIGHT, Word.NOISY, Word.NOT_APPLICABLE)


def judge(pixels: Values, own_errors: Values, truth: float, allowed: float) -> tuple[Word, float, float]:
    """Word, relative deviation and its standard error, from pixels that all measure the same.

    Pixels are independent, so their mean follows Student's t, unless single pixels dominate the sum: then
    the word is noisy whatever the deviation. `own_errors` are the pixels' standard errors as an image gives
    them, never too small but by a heavy tail: pixels that scatter far more do not measure the same.
    """
    mean = float(pixels.mean())
    if truth == 0.0:
        # Nothing may arrive at all.
        return (Word.RIGHT if not pixels.any() else Word.BIASED), mean, 0.0
    error = float(pixels.std(ddof=1)) / pixels.size**0.5 / truth
    off = mean / truth - 1.0
    if mean == 0.0:
        return Word.NOTHING, off, error
    if float(pixels.max()) > HEAVY * float(pixels.sum()):
        return Word.NOISY, off, error
    if abs(off) > student_bound(CELLS, pixels.size - 1) * error + allowed:
        return Word.BIASED, off, error
    if error <= NOISY:
        return Word.RIGHT, off, error
    own = float((own_errors**2).mean()) ** 0.5
    return (Word.UNEVEN if float(pixels.std(ddof=1)) > UNEVEN * own else Word.NOISY), off, error
