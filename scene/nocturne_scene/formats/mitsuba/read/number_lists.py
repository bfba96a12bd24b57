"""Numbers as Mitsuba's files write them."""

import math
import re

from nocturne_scene.errors import InputError

_SEPARATORS = re.compile(r"[\s,]+")

# Numbers of one value: far more than a matrix has, as many as a table of 1 nm has.
_MAX_NUMBERS = 20_000


def numbers(text: str, place: str, count: int | None = None) -> list[float]:
    """Numbers with spaces or commas between them. Raises InputError."""
    parts = [part for part in _SEPARATORS.split(text.strip()) if part]
    if len(parts) > _MAX_NUMBERS:
        raise InputError.at(place, f"more than {_MAX_NUMBERS:,} numbers")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        raise InputError.at(place, f'expected numbers, found "{text.strip()[:60]}"') from None
    if not all(math.isfinite(value) for value in values):
        raise InputError.at(place, f'expected finite numbers, found "{text.strip()[:60]}"')
    if count is not None and len(values) != count:
        raise InputError.at(place, f"expected {count} numbers, found {len(values)}")
    return values
