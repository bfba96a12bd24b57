"""Where a film's pixels are, in metres, and which parts of it are instruments: what an image's header says of
its sensor."""

import json
from dataclasses import dataclass, field
from typing import Any, Self

from nocturne_scene.photometry.outlines import Outline

ATTRIBUTE = "nocturne:instruments"

Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Part:
    """Pixels of one instrument, or of a whole film."""

    name: str
    measures: str
    left: int
    top: int
    columns: int
    rows: int
    first: Place = (0.0, 0.0, 0.0)
    """The middle of the upper left pixel."""
    across: Place = (0.0, 0.0, 0.0)
    """From there to the next ones."""
    down: Place = (0.0, 0.0, 0.0)
    places: tuple[Place, ...] = ()
    """Of points without order."""

    @property
    def outline(self) -> Outline:
        """Of its pixels."""
        right, bottom = self.left + self.columns, self.top + self.rows
        return Outline("rectangle", ((float(self.left), float(self.top)), (float(right), float(bottom))))

    def place(self, x: int, y: int) -> Place | None:
        """Of a pixel; None outside."""
        column, row = x - self.left, y - self.top
        if not (0 <= column < self.columns and 0 <= row < self.rows):
            return None
        if self.places:
            index = row * self.columns + column
            return self.places[index] if index < len(self.places) else None
        steps = zip(self.first, self.across, self.down, strict=True)
        a, b, c = (start + column * right + row * down for start, right, down in steps)
        return (a, b, c)


@dataclass(frozen=True, slots=True)
class Places:
    """Of an image; empty: a sensor that has none."""

    parts: tuple[Part, ...] = ()
    outdoor: str = ""
    """The instrument whose mean is the illuminance outdoors."""
    is_of_meters: bool = field(default=False)

    @classmethod
    def read(cls, text: str, width: int, height: int) -> Self:
        """From a header and the image's size; empty where it has none, or one that is not understood."""
        try:
            told = json.loads(text) if text else {}
            if "film" in told:
                return cls((_film(told["film"], width, height),))
            found = tuple(_part(each) for each in told.get("instruments", ()))
            return cls(found, str(told.get("outdoor", "")), bool(found))
        except (ValueError, TypeError, KeyError, AttributeError):
            return cls()

    def place(self, x: int, y: int) -> Place | None:
        """Of a pixel, m; None where it is not known."""
        found = (part.place(x, y) for part in self.parts)
        return next((place for place in found if place is not None), None)

    def outlines(self) -> list[tuple[str, Outline]]:
        """Instruments by name."""
        return [(part.name, part.outline) for part in self.parts] if self.is_of_meters else []


def _film(told: dict[str, Any], width: int, height: int) -> Part:
    centre, right, up = (_place(told[name]) for name in ("centre", "right", "up"))
    pixel = float(told["height"]) / height
    across, down = tuple(pixel * each for each in right), tuple(-pixel * each for each in up)
    x, y = 0.5 * (width - 1), 0.5 * (height - 1)
    first = tuple(c - x * a - y * d for c, a, d in zip(centre, across, down, strict=True))
    return Part("", "plane", 0, 0, width, height, _place(first), _place(across), _place(down))


def _part(told: dict[str, Any]) -> Part:
    left, top, columns, rows = (int(each) for each in told["pixels"])
    named = str(told["name"]), str(told["measures"])
    if "places" in told:
        places = tuple(_place(each) for each in told["places"])
        return Part(*named, left, top, columns, rows, places=places)
    first, across, down = (_place(told[name]) for name in ("first", "across", "down"))
    return Part(*named, left, top, columns, rows, first, across, down)


def _place(values: Any) -> Place:
    a, b, c = (float(each) for each in values)
    return (a, b, c)
