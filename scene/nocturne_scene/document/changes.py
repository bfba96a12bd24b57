"""Changes of a scene document before it is read: `sensor.position[0]` and its new value."""

import copy
import re
from collections.abc import Iterator, Mapping
from typing import Any

from nocturne_scene.errors import InputError

_STEP = re.compile(r"\.?([A-Za-z_][A-Za-z0-9_ -]*)|\[(\d+)\]")


def changed(document: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The document with these values at these places; InputError where there is no such place."""
    made = copy.deepcopy(dict(document))
    for place, value in changes.items():
        *way, last = _steps(place)
        at: Any = made
        for step in way:
            at = _inside(at, step, place)
        _inside(at, last, place)
        at[last] = value
    return made


def _steps(place: str) -> Iterator[str | int]:
    path = place.removeprefix("$.")
    steps = [*_STEP.finditer(path)]
    if not steps or "".join(step[0] for step in steps) != path:
        raise InputError.at(place, "is no place in a scene, such as surfaces[2].kernel.reflectance")
    return (int(step[2]) if step[1] is None else step[1] for step in steps)


def _inside(at: Any, step: str | int, place: str) -> Any:
    """The value there; an object that is not there yet is made, as the default of most parts."""
    if isinstance(step, str) and isinstance(at, dict):
        return at.setdefault(step, {})
    if isinstance(step, int) and isinstance(at, list) and step < len(at):
        return at[step]
    raise InputError.at(place, "is no place in this scene")
