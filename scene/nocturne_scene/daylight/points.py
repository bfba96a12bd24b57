"""The points of a room at which a year of daylight is measured."""

from dataclasses import dataclass

from nocturne_scene.spectra.published import Floats


@dataclass(frozen=True)
class Instrument:
    """Points that belong together."""

    name: str
    columns: int
    rows: int
    is_grid: bool
    """Side by side as in its plan, row by row from the upper left one."""


@dataclass(frozen=True)
class Points:
    """Where daylight is measured."""

    instruments: list[Instrument]
    names: list[str]
    """Of the instrument, by point."""
    places: Floats
    """By point, m."""
    film: tuple[int, int]
    """Columns and rows of one batch."""
    pixels: list[int]
    """On that film, by point."""
