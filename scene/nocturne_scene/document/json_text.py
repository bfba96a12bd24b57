"""Decodes JSON text within bounds, remembering what JSON leaves open: duplicate keys and depth."""

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any

from nocturne_scene import limits
from nocturne_scene.document import bounds
from nocturne_scene.document.problems import path
from nocturne_scene.errors import InputError, Problem

_STEPS_SHOWN = 8


def decode_json(text: bytes | str) -> Any:
    """Return the value that `text` holds, with plain dicts and lists.

    NaN and Infinity, which are no JSON, become floats for the schema to refuse where they stand. Raises
    InputError for text that is too long, not UTF-8, no JSON, nested too deep, or has an object with the same
    key twice.
    """
    try:
        value = json.loads(_as_text(text), object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise InputError.at(
            "$", f"not JSON: {error.msg}, line {error.lineno}, column {error.colno}"
        ) from None
    except RecursionError:
        raise InputError([_too_deep("$")]) from None
    except ValueError:
        # The only other one: Python refuses to convert integers of thousands of digits.
        raise InputError.at("$", "not JSON: a number has too many digits") from None
    problems = _first(_structural_problems(value)) if _is_suspicious(value) else []
    if problems:
        raise InputError(problems)
    return value


def _as_text(text: bytes | str) -> str:
    size = len(text)
    if isinstance(text, str) and size <= limits.MAX_SCENE_BYTES:
        size = len(text.encode("utf-8", "surrogatepass"))
    if size > limits.MAX_SCENE_BYTES:
        most = f"at most {limits.MAX_SCENE_BYTES} bytes are accepted"
        raise InputError.at(
            "$", f"the document is too long; {most}; put large meshes into files of their own"
        )
    if isinstance(text, str):
        return text
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError.at("$", f"not UTF-8: byte {error.start} is not valid") from None


class _AmbiguousObject(dict[str, Any]):
    """A JSON object with keys that came more than once."""

    repeated: list[str]


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    plain = dict(pairs)
    if len(plain) == len(pairs):
        return plain
    ambiguous = _AmbiguousObject(plain)
    counts = Counter(key for key, _ in pairs)
    ambiguous.repeated = [key for key, count in counts.items() if count > 1]
    return ambiguous


def _is_suspicious(root: Any) -> bool:
    """Whether a walk that keeps track of places will find something; this one is far cheaper."""
    level = [root]
    for _ in range(limits.MAX_SCENE_NESTING):
        inner: list[Any] = []
        for value in level:
            if isinstance(value, dict):
                if isinstance(value, _AmbiguousObject):
                    return True
                inner.extend(child for child in value.values() if isinstance(child, dict | list) and child)
            elif isinstance(value, list):
                inner.extend(child for child in value if isinstance(child, dict | list) and child)
        level = inner
        if not level:
            return False
    return True


def _structural_problems(root: Any) -> Iterator[Problem]:
    """Walk all containers without recursion; those that are too deep are not entered."""
    waiting: list[tuple[tuple[str | int, ...], Any]] = [((), root)]
    while waiting:
        steps, value = waiting.pop()
        if not isinstance(value, dict | list):
            continue
        if len(steps) >= limits.MAX_SCENE_NESTING:
            yield _too_deep(path(steps[:_STEPS_SHOWN]) + "...")
            continue
        if isinstance(value, _AmbiguousObject):
            for key in value.repeated:
                yield Problem(path((*steps, key)), "this key stands more than once in its object")
        children = value.items() if isinstance(value, dict) else enumerate(value)
        waiting.extend(((*steps, step), child) for step, child in children if isinstance(child, dict | list))


def _too_deep(place: str) -> Problem:
    return Problem(place, f"nested deeper than {limits.MAX_SCENE_NESTING} levels")


def _first(problems: Iterator[Problem]) -> list[Problem]:
    return [problem for problem, _ in zip(problems, range(bounds.PROBLEMS), strict=False)]
