"""What an image is made of."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Film:
    """Pixels, and samples for each."""

    width: int
    height: int
    samples: int

    @property
    def all_samples(self) -> int:
        return self.width * self.height * self.samples
