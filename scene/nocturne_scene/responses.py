"""What the sensor's further responses may be called."""

import re
from collections.abc import Iterator, Sequence

from nocturne_scene.bands import is_band
from nocturne_scene.limits import MAX_FURTHER_RESPONSES

_NAME = re.compile("[A-Za-z][A-Za-z0-9_-]{0,30}")
# What an EXR's channels mean by convention, or here.
_TAKEN = frozenset("XYZRGBAn")

LIGHT_PARTS = {part: tuple(f"{part}.{axis}" for axis in "XYZ") for part in ("direct", "indirect")}
"""Names of responses to a part of the light, by part."""

COLOUR = tuple(f"colour.{number:02d}" for number in range(43))
"""Names of responses that give a light's colour, by wavelength; `spectra.colour_basis` has their curves."""

_OF_SENSORS = frozenset(name for names in LIGHT_PARTS.values() for name in names) | frozenset(COLOUR)


def name_problems(names: Sequence[str]) -> Iterator[str]:
    """Problems of the names of a sensor's further responses, in words."""
    if len(names) > MAX_FURTHER_RESPONSES:
        yield f"{len(names)} further responses; at most {MAX_FURTHER_RESPONSES}"
    for index, name in enumerate(names):
        if name in names[:index]:
            yield f"two responses are named {name!r}"
        elif is_band(name) or name in _OF_SENSORS:
            continue
        elif not _NAME.fullmatch(name):
            yield (
                f"{name[:40]!r} can't be a response's name: expected a letter, "
                "then at most 30 letters, digits, '_' and '-'"
            )
        elif name in _TAKEN:
            yield f"{name!r} can't be a response's name: it means another channel of an image"
