"""Changes of a scene document before it is submitted: `sensor.position[0]` and its new value."""

import copy
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from nocturne_client.errors import NocturneClientError

_STEP = re.compile(r"\.?([A-Za-z_][A-Za-z0-9_ -]*)|\[(\d+)\]")
_BANDS = re.compile(r"(\d+):(\d+):(\d+)")


def changed(document: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The document with these values at these places; raises NocturneClientError where there is no such
    place."""
    made = copy.deepcopy(dict(document))
    for place, value in changes.items():
        *way, last = _steps(place)
        at: Any = made
        for step in way:
            at = _inside(at, step, place)
        _inside(at, last, place)
        at[last] = value
    return made


def parse_change(text: str) -> tuple[str, Any]:
    """`path=value`; a value that is no JSON is text. Raises NocturneClientError."""
    place, equals, value = text.partition("=")
    if not equals or not place.strip():
        raise NocturneClientError(f"{text!r}: expected a place and a value, such as sensor.position[0]=1.5")
    try:
        return place.strip(), json.loads(value)
    except ValueError:
        return place.strip(), value


def parse_bands(text: str) -> dict[str, Any]:
    """380:780:10 as the change of a document; raises NocturneClientError. Nothing for an empty text."""
    if not text:
        return {}
    match = _BANDS.fullmatch(text.strip())
    if match is None:
        raise NocturneClientError(f"--bands {text!r}: expected FIRST:LAST:WIDTH in nm, such as 380:780:10")
    first, last, width = (int(number) for number in match.groups())
    return {"sensor.bands": {"first": first, "last": last, "width": width}}


def _steps(place: str) -> Sequence[str | int]:
    steps: list[str | int] = []
    end = 0
    for match in _STEP.finditer(place.removeprefix("$.")):
        if match.start() != end:
            break
        steps.append(match[1] if match[2] is None else int(match[2]))
        end = match.end()
    if not steps or end != len(place.removeprefix("$.")):
        raise NocturneClientError(f"{place!r} is no place in a scene, such as surfaces[2].kernel.reflectance")
    return steps


def _inside(at: Any, step: str | int, place: str) -> Any:
    """The value there; an object that is not there yet is made, as the default of most parts."""
    if isinstance(step, str) and isinstance(at, dict):
        return at.setdefault(step, {})
    if isinstance(step, int) and isinstance(at, list) and step < len(at):
        return at[step]
    raise NocturneClientError(f"the scene has no {place}")
