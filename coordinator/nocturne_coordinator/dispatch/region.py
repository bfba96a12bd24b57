"""A rectangle of the film: which part of it gets its samples first. Pure."""

import json
from dataclasses import asdict, dataclass
from typing import Self

from nocturne_scene.errors import InputError
from nocturne_scene.ranges import TileGrid


@dataclass(frozen=True, slots=True)
class Region:
    """Pixels [x, x + width) times [y, y + height)."""

    x: int
    y: int
    width: int
    height: int

    def check(self, film_width: int, film_height: int) -> None:
        """Raises InputError at `$` unless it lies in the film and is not empty."""
        fits_x = self.x >= 0 and self.width >= 1 and self.x + self.width <= film_width
        fits_y = self.y >= 0 and self.height >= 1 and self.y + self.height <= film_height
        if not (fits_x and fits_y):
            raise InputError.at("$", f"expected a rectangle within the film of {film_width} x {film_height}")

    def tiles(self, grid: TileGrid) -> frozenset[int]:
        """The tiles that have pixels in it."""
        size = grid.tile_size
        rows = range(self.y // size, (self.y + self.height - 1) // size + 1)
        columns = range(self.x // size, (self.x + self.width - 1) // size + 1)
        return frozenset(row * grid.columns + column for row in rows for column in columns)

    def to_json(self) -> str:
        """On one line."""
        return json.dumps(asdict(self), separators=(",", ":"))

    @classmethod
    def from_json(cls, text: str) -> Self:
        """What `to_json` gave."""
        return cls(**json.loads(text))
