"""What the default is worth on films of 1920 x 1080, of scenes that are lit by what mirrors gather."""

import tempfile
from pathlib import Path

from bench.efficiency import Size, efficiencies, rows_of
from bench.peer.contenders import FilmSize
from bench.report import Figures, Row
from bench.scenes import example

_SCENES = ("reflector", "headlight")
_FULL = Size(FilmSize(1920, 1080), 256, 60.0, 1, 4, 60.0)
_QUICK = Size(FilmSize(96, 54), 256, 0.2, 1, 2, 0.4)


def run(quick: bool) -> Figures:
    """All ways on both, one image each."""
    figures = {}
    for name in _SCENES:
        with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
            document = {key: value for key, value in example(name, Path(folder)).items() if key != "tracing"}
            figures[name] = efficiencies(document, Path(folder), _QUICK if quick else _FULL)
    return figures


def rows(figures: Figures) -> list[Row]:
    """The default against two others."""
    return [row for name in _SCENES for row in rows_of(f"{name}, 1920 x 1080", figures[name])]
