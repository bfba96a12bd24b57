"""Adds to an EXR of nocturne-trace what only Python knows; all that was in it stays as it is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import OpenEXR
from nocturne_scene.layers import read_layers


def note_doubt(image: Path, doubt: str) -> None:
    """Writes into an EXR why its errors are not to be trusted, as those of the service say it."""
    _rewrite(image, {"nocturne:errorDoubt": doubt}, {})


def add_layers(image: Path, layers: Path) -> None:
    """Puts layers beside the image, as the service does."""
    read = read_layers(layers)
    _rewrite(image, read.attributes, read.channels)


def _rewrite(image: Path, attributes: Mapping[str, str], channels: Mapping[str, Any]) -> None:
    with OpenEXR.File(str(image), separate_channels=True) as file:
        before = {name: channel.pixels for name, channel in file.channels().items()}
        header = {**file.header(), **attributes}
    header.pop("channels", None)
    # A sensor may have responses with such names: they go first.
    with OpenEXR.File(header, {**channels, **before}) as file:
        file.write(str(image))
