"""Which public scenes are rendered, and where they come from."""

import os
from collections.abc import Iterator
from pathlib import Path

from bench.report import Skipped
from tests.corpus.__main__ import There, files

MIRRORS = "NOCTURNE_MIRRORS"
"""Variable that names the folder with clones of the repositories in tests/corpus/sources.toml."""

_FORMAT = "Mitsuba 0.x"
_DPPM, _IMPROVED, _PRACTICAL = (
    "hchoi405/dppm-scenes",
    "yysun997/improved-path-guiding",
    "takkasila/practical_path_guiding_lab",
)
SCENES = {
    "veach-bidir": (_PRACTICAL, "veach-bidir"),
    "veach-mis": (_PRACTICAL, "veach-mis"),
    "veach-ajar": (_PRACTICAL, "veach-ajar"),
    "torus": (_PRACTICAL, "torus"),
    "veach-lamp": (_DPPM, "veach-lamp"),
    "living-room": (_DPPM, "living-room"),
    "dining-room": (_DPPM, "dining-room"),
    "bathroom": (_DPPM, "bathroom"),
    "staircase": (_DPPM, "staircase"),
    "country-kitchen": (_IMPROVED, "country_kitchen"),
    "kitchenette": (_IMPROVED, "kitchenette"),
    "glass-of-water": (_IMPROVED, "glass_of_water"),
    "sponza": (_DPPM, "sponza"),
    "spaceship": (_DPPM, "spaceship"),
    "living-room-2": (_DPPM, "living-room-2"),
    "clocks": (_IMPROVED, "clocks"),
}
"""By name: the repository, and the folder in its `scenes`."""


def there(names: set[str]) -> Iterator[tuple[str, There]]:
    """Those of these scenes that are there, each with its files for as long as it is looked at.

    Raises Skipped where no folder is named.
    """
    mirrors = os.environ.get(MIRRORS)
    if not mirrors:
        raise Skipped(f"{MIRRORS} names no folder with clones of repositories in tests/corpus/sources.toml")
    wanted = {(where, f"scenes/{folder}/scene.xml"): name for name, (where, folder) in SCENES.items()}
    for each in files(Path(mirrors), _FORMAT):
        name = wanted.get((each.repository, each.name))
        if name in names:
            yield name, each
