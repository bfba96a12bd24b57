"""What a suite is: scenes to render, and the values that are to be read from them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from nocturne_scene.validation.documents import RANGE_NM, Document

Quantity = Literal["Y", "PAR", "grey", "S1.grey", "S2.grey", "S3.grey", "u'", "v'"]
"""`PAR`: the channel of that named response; `grey`: the mean over wavelength of a further response of that
name, as `documents.GREY` has it, and of its Stokes parameters; u', v': chromaticity (CIE 1976)."""


@dataclass(frozen=True)
class Value:
    """A number that is known."""

    name: str
    truth: float
    source: str
    """Where the truth is from."""
    quantity: Quantity = "grey"
    factor: float = 1.0
    """The reading times this, plus `plus`, is compared with the truth."""
    plus: float = 0.0

    def of(self, reading: float) -> float:
        """From what the image says."""
        return self.scale * reading + self.plus

    @property
    def scale(self) -> float:
        """Of readings and their errors."""
        return self.factor / (RANGE_NM if self.quantity.endswith("grey") else 1.0)


@dataclass(frozen=True)
class Scene:
    """A document to render, and what the mean over its film is to show."""

    document: Document
    values: tuple[Value, ...]
    samples: int = 2**17
    film: tuple[int, int] = (1, 1)
    """Width and height, pixels."""


@dataclass(frozen=True)
class Suite:
    """Values of one kind."""

    name: str
    about: str
    """A sentence."""
    scenes: Callable[[], Iterator[Scene]]
