"""What whoever imports a scene can choose."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nocturne_scene.errors import Problem
from nocturne_scene.formats.reading.scene_writer import FilmSettings


@dataclass(frozen=True)
class ImportOptions:
    """Options of an import."""

    root: Path | None = None
    """The folder that all files lie in; None: that of the scene file."""
    parameters: Mapping[str, str] = field(default_factory=dict)
    """Values for `$name` in Mitsuba's files, instead of their defaults."""
    light_radius: float | None = None
    """Metres, of a lamp without a size; None: by the scene (`Extent.lamp_radius`)."""
    light_degrees: float = 0.1
    """Angular diameter of a lamp at infinity without a size; at least 0.01."""
    light: str | None = None
    """`sky`, `studio` or a picture's file, for a scene without a sky; None: the sky where nothing emits."""
    time: float | None = None
    """Seconds into the scene's animation; None: everything as at rest."""
    allow_missing: bool = False
    """Write the scene although something in it has no counterpart here."""


@dataclass(frozen=True)
class Imported:
    """A scene that was written to a folder."""

    document: Path
    film: FilmSettings
    notes: list[str]
    """Parts whose form is different here."""
    missing: list[Problem]
    """Parts without a counterpart here; empty unless that was allowed."""
