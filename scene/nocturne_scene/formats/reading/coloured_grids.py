"""Media whose colour varies in space, as several media in one body: they add up, and each has one spectrum.

Red, green and blue of a grid are the amounts of three spectra that add up to 1 at every wavelength, so that
grey stays grey.
"""

from collections.abc import Sequence
from functools import lru_cache

from nocturne_scene.formats.reading import colours, grids
from nocturne_scene.formats.reading.grids import Grid
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter

Part = tuple[Json, Grid, Grid | None]
"""Fields of a medium, the grid of its density, and one that this is multiplied with."""


@lru_cache(maxsize=1)
def primaries() -> tuple[Json, Json, Json]:
    """Spectra of red, green and blue: their smooth reflectances, over the sum of the three."""
    at = colours.SMOOTH
    red, green, blue = (
        colours.values_of({"rgb": [float(index == each) for each in range(3)]}, at) for index in range(3)
    )
    total = red + green + blue
    return (
        colours.table(at, red / total),
        colours.table(at, green / total),
        colours.table(at, blue / total),
    )


def by_channel(spectrum: Json, channels: int) -> list[Json]:
    """A coefficient's spectrum for each of so many channels."""
    if channels == 1:
        return [spectrum]
    found = []
    for primary in primaries():
        at = colours.knots(primary, spectrum)
        found.append(colours.table(at, colours.values_of(primary, at) * colours.values_of(spectrum, at)))
    return found


def add(writer: SceneWriter, name: str, parts: Sequence[Part], factor: float, place: str) -> list[str]:
    """Write media; returns their names. Empty ones are left out."""
    return [
        writer.name(
            "media", name, {**fields, "density": grids.density(writer, grid, factor, place, times=times)}
        )
        for fields, grid, times in parts
        if grid.values.any() and (times is None or times.values.any())
    ]
