"""Overlays: documents that add to another scene document, and change and remove its parts by name."""

import copy
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from nocturne_client.errors import Problem

Json = dict[str, Any]

NAMED = ("spectra", "textures", "kernels", "media", "groups")
"""Parts of a document that are objects by name."""
LISTED = ("surfaces", "instances")
"""Lists of parts that have a name."""
ADDED = (*NAMED, *LISTED, "distant", "ray_files", "important_directions", "unbounded_media")
"""Parts of an overlay that come to those of the base."""
WHOLE = (
    "nocturne",
    "name",
    "source",
    "note",
    "wavelengths",
    "sensor",
    "atmosphere",
    "environment",
    "tracing",
)
"""Parts of an overlay that take the place of those of the base; null removes one."""
CHANGES = ("replace", "remove")
_MOST_NAMES = 40


def is_overlay(document: Mapping[str, Any]) -> bool:
    """Whether a document is an overlay."""
    return "base" in document


def laid_over(base: Json, overlay: Json) -> tuple[Json, list[Problem]]:
    """The scene document that an overlay makes of its base, and the problems of the overlay.

    Removals come first, then replacements, then additions. `replace` takes named entries whole, and of
    surfaces and instances only the fields that it gives, in all of that name; null removes a field.
    """
    made, problems = copy.deepcopy(base), list[Problem]()
    known = {"base", *CHANGES, *ADDED, *WHOLE}
    for key in overlay.keys() - known:
        problems.append(Problem(f"$.{key}", f"expected one of {_listed(known)}"))
    for change, act in (("remove", _removed), ("replace", _replaced)):
        for part, value in _parts(overlay, change, problems):
            problems.extend(act(made, part, value, f"$.{change}.{part}"))
    for part in ADDED:
        if part in overlay:
            problems.extend(_added(made, part, overlay[part]))
    for part in WHOLE:
        if part in overlay and overlay[part] is None:
            made.pop(part, None)
        elif part in overlay:
            made[part] = copy.deepcopy(overlay[part])
    return made, problems


def _parts(overlay: Json, change: str, problems: list[Problem]) -> Iterator[tuple[str, Any]]:
    told = overlay.get(change, {})
    if not isinstance(told, dict):
        problems.append(Problem(f"$.{change}", 'expected an object, such as {"surfaces": ...}'))
        return
    for part, value in told.items():
        if part in (*NAMED, *LISTED):
            yield part, value
        else:
            problems.append(Problem(f"$.{change}.{part}", f"expected one of {_listed((*NAMED, *LISTED))}"))


def _removed(made: Json, part: str, names: Any, place: str) -> Iterator[Problem]:
    if not isinstance(names, list):
        yield Problem(place, "expected a list of names")
        return
    for index, name in enumerate(names):
        if not _count(made, part, name):
            yield _unknown(made, part, name, f"{place}[{index}]")
        elif part in NAMED:
            del made[part][name]
        else:
            _walk(made, part, partial(_without, name))


def _replaced(made: Json, part: str, by_name: Any, place: str) -> Iterator[Problem]:
    if not isinstance(by_name, dict):
        yield Problem(place, "expected an object with an entry for each name")
        return
    for name, value in by_name.items():
        if not _count(made, part, name):
            yield _unknown(made, part, name, place)
        elif part in NAMED:
            made[part][name] = copy.deepcopy(value)
        elif not isinstance(value, dict):
            yield Problem(f"{place}[{name!r}]", "expected an object with the fields that are new")
        else:
            _walk(made, part, partial(_with_fields, name, value))


def _without(name: str, entry: Json) -> Json | None:
    return None if entry.get("name") == name else entry


def _with_fields(name: str, fields: Json, entry: Json) -> Json:
    if entry.get("name") != name:
        return entry
    new = {**entry, **copy.deepcopy(fields)}
    return {key: value for key, value in new.items() if value is not None}


def _added(made: Json, part: str, value: Any) -> Iterator[Problem]:
    if part not in NAMED:
        there = made.setdefault(part, [])
        if isinstance(value, list) and isinstance(there, list):
            there.extend(copy.deepcopy(value))
        else:
            yield Problem(f"$.{part}", "expected a list, here and in the base")
        return
    there = made.setdefault(part, {})
    if not isinstance(value, dict) or not isinstance(there, dict):
        yield Problem(f"$.{part}", "expected an object, here and in the base")
        return
    for name, entry in value.items():
        if name in there:
            yield Problem(f"$.{part}", f'the base has {name!r} already; "replace" takes its place')
        there[name] = copy.deepcopy(entry)


def _walk(made: Json, part: str, change: Callable[[Json], Json | None]) -> None:
    """Changes the surfaces or instances of the document and its groups; None removes one."""
    lists = [made, *(made.get("groups") or {}).values()] if isinstance(made.get("groups"), dict) else [made]
    for holder in lists:
        entries = holder.get(part) if isinstance(holder, dict) else holder
        if not isinstance(entries, list):
            continue
        kept = [
            change(each) if isinstance(each, dict) and _is(part, each, holder is made) else each
            for each in entries
        ]
        entries[:] = [each for each in kept if each is not None]


def _is(part: str, entry: Json, at_top: bool) -> bool:
    """Whether an entry of a list is of that part; groups hold both surfaces and instances."""
    return at_top or ("group" in entry) == (part == "instances")


def _names(made: Json, part: str) -> list[str]:
    if part in NAMED:
        there = made.get(part)
        return [*there] if isinstance(there, dict) else []
    found = dict[str, None]()

    def noted(entry: Json) -> Json:
        if isinstance(name := entry.get("name"), str) and name:
            found[name] = None
        return entry

    _walk(made, part, noted)
    return [*found]


def _count(made: Json, part: str, name: Any) -> bool:
    return isinstance(name, str) and name in _names(made, part)


def _unknown(made: Json, part: str, name: Any, place: str) -> Problem:
    names = _names(made, part)
    return Problem(place, f"the base has no {part} named {name!r}; it has {_listed(names) or 'none'}")


def _listed(names: Any) -> str:
    ordered = sorted(names)
    more = f" and {len(ordered) - _MOST_NAMES} more" if len(ordered) > _MOST_NAMES else ""
    return ", ".join(ordered[:_MOST_NAMES]) + more
