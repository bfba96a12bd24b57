"""What the default is worth where light is hard to find: scenes made to fool the pilot."""

import tempfile
from pathlib import Path

from bench.efficiency import Size, efficiencies, rows_of
from bench.peer.contenders import FilmSize
from bench.report import Figures, Row
from bench.trap_scenes import TRAPS

_FILM, _SAMPLES = FilmSize(48, 32), 2**13
"""12 million in all."""
_FULL, _QUICK = Size(_FILM, _SAMPLES, 0.5, 3, 6, 2.0), Size(_FILM, _SAMPLES, 0.05, 2, 2, 0.1)


def run(quick: bool) -> Figures:
    """All ways on all scenes."""
    size, figures = _QUICK if quick else _FULL, {}
    for name, document in TRAPS.items():
        with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
            figures[name] = efficiencies(document(), Path(folder), size)
    return figures


def rows(figures: Figures) -> list[Row]:
    """The default against two others."""
    return [row for name in TRAPS for row in rows_of(name, figures[name])]
