"""A scene that fails, made smaller as long as it fails: delta debugging over a document's parts.

After A. Zeller and R. Hildebrandt, "Simplifying and Isolating Failure-Inducing Input", 2002. It knows
nothing of what fields mean: what makes no sense is refused by the compiler, and counts as no failure.
"""

import sys
import time
from collections.abc import Callable, Iterator
from copy import deepcopy
from itertools import islice
from typing import Any

Path = tuple[str | int, ...]

_SIMPLE: tuple[Any, ...] = ({"type": "lambertian", "reflectance": 0.5}, 0.5, 1.0)
"""Simple values that may replace a more complicated one."""
_INNER = ("kernel", "first", "second", "front", "back")
"""Fields whose value may stand for the whole."""
_WHOLE = ("vertices", "triangles", "normals", "texture_coordinates", "layers", "table")
"""Fields that mean something only as a whole: a body without one of its triangles is none."""
_NAMED = ("spectra", "textures", "kernels")


def reduced(whole: Any, fails: Callable[[Any], bool], seconds: float, tries: int = sys.maxsize) -> Any:
    """The smallest that was found in this time and by so many tries, and still fails. `whole` is JSON and
    fails."""
    end = time.monotonic() + seconds
    best, tried = whole, set[str]()
    changed = True
    while changed:
        changed, place = False, 0
        while (smaller := next(islice(_smaller(best), place, None), None)) is not None:
            if time.monotonic() > end or len(tried) >= tries:
                return best
            key = repr(smaller)
            if key not in tried and fails(smaller):
                # Places before this one are tried again after all others.
                best, changed = smaller, True
            else:
                place += 1
            tried.add(key)
    return best


def inlined(document: dict[str, Any]) -> dict[str, Any]:
    """With spectra, textures and kernels where they are used instead of their names."""
    named = {name: value for kind in _NAMED for name, value in document.get(kind, {}).items()}

    def written(value: Any) -> Any:
        if isinstance(value, dict):
            return {name: written(inner) for name, inner in value.items()}
        if isinstance(value, list):
            return [written(inner) for inner in value]
        return written(named[value]) if isinstance(value, str) and value in named else value

    return {name: written(value) for name, value in document.items() if name not in _NAMED}


def _smaller(whole: Any) -> Iterator[Any]:
    """Large parts first: halves of lists, then fields and entries from the outside inwards."""
    paths = sorted(_paths(whole, ()), key=len)
    for path in paths:
        value = _at(whole, path)
        if isinstance(value, list) and len(value) > 3 and not isinstance(value[0], int | float):
            half = len(value) // 2
            for kept in (value[half:], value[:half]):
                yield _with(whole, path, kept)
    for path in paths:
        if path:
            yield _without(whole, path)
    for path in paths:
        value = _at(whole, path)
        if isinstance(value, dict):
            for name in _INNER:
                if isinstance(value.get(name), dict) and path:
                    yield _with(whole, path, value[name])
            for simple in (*_SIMPLE, *_ball(value)):
                if path and value != simple and len(repr(value)) > len(repr(simple)):
                    yield _with(whole, path, simple)


def _ball(shape: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A sphere where a mesh or a box is."""
    points = shape.get("vertices", [shape[name] for name in ("minimum", "maximum") if name in shape])
    if len(points) > 1 and all(isinstance(each, list) for each in points):
        low, high = ([pick(axis) for axis in zip(*points, strict=True)] for pick in (min, max))
        centre = [round(0.5 * (a + b), 4) for a, b in zip(low, high, strict=True)]
        radius = 0.4 * min(b - a for a, b in zip(low, high, strict=True))
        yield {"type": "sphere", "centre": centre, "radius": round(radius, 4) or 0.1}


def _paths(value: Any, path: Path) -> Iterator[Path]:
    """Of all parts but the numbers of vectors."""
    yield path
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from [(*path, name)] if name in _WHOLE else _paths(inner, (*path, name))
    elif isinstance(value, list) and not all(isinstance(each, int | float) for each in value):
        for index, inner in enumerate(value):
            yield from _paths(inner, (*path, index))


def _at(whole: Any, path: Path) -> Any:
    for step in path:
        whole = whole[step]
    return whole


def _with(whole: Any, path: Path, value: Any) -> Any:
    if not path:
        return value
    made = deepcopy(whole)
    _at(made, path[:-1])[path[-1]] = deepcopy(value)
    return made


def _without(whole: Any, path: Path) -> Any:
    made = deepcopy(whole)
    del _at(made, path[:-1])[path[-1]]
    return made
