"""What of the scene language a document uses, found by the schema itself: nothing new is left out silently.

A feature is a type (`Sphere`), a field that is given (`Sphere.radius`), or a choice among few words
(`Dielectric.distribution=ggx`).
"""

from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.node import Node


def features_of(node: Any) -> set[str]:
    """Of a document that was read, or of a part of it."""
    return set(_found(node))


def _found(value: Any) -> Iterator[str]:
    if isinstance(value, Node):
        kind = type(value)
        yield kind.__name__
        for name in value.model_fields_set:
            inner = getattr(value, name)
            yield f"{kind.__name__}.{name}"
            if _words(kind.model_fields[name].annotation, inner):
                yield f"{kind.__name__}.{name}={inner}"
            yield from _found(inner)
    elif isinstance(value, dict):
        for each in value.values():
            yield from _found(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _found(each)


def _words(annotation: Any, value: Any) -> bool:
    return isinstance(value, str | int) and value in set(_literals(annotation))


def all_features() -> set[str]:
    """All that the schema has."""
    found: set[str] = set()
    waiting: list[type[Node]] = [SceneDocument]
    seen: set[type[Node]] = set()
    while waiting:
        kind = waiting.pop()
        if kind in seen:
            continue
        seen.add(kind)
        found.add(kind.__name__)
        for name, field in kind.model_fields.items():
            found.add(f"{kind.__name__}.{name}")
            found.update(f"{kind.__name__}.{name}={word}" for word in _literals(field.annotation))
            waiting += _nodes(field.annotation)
    return found


def _literals(annotation: Any) -> Iterator[Any]:
    """Words among which a field chooses, without those of its parts, which have their own fields."""
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
        return
    for inner in get_args(annotation):
        if not isinstance(inner, type):
            yield from _literals(inner)


def _nodes(annotation: Any) -> Iterator[type[Node]]:
    if isinstance(annotation, type) and not get_args(annotation):
        if issubclass(annotation, Node):
            yield annotation
        return
    for inner in get_args(annotation):
        yield from _nodes(inner)
