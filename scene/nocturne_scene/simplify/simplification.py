"""A scene document with one part less. Documents are decoded JSON; none is changed in place."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Document = dict[str, Any]

Find = Callable[[str], Path]
"""The file of an asset reference (`sha256:...`)."""


@dataclass(frozen=True)
class Simplification:
    """One part left out or made simpler."""

    name: str
    """In words for a report, such as `without medium "fog"`."""
    edit: Callable[[Document], None]
    """Changes a document in place; does nothing to one that has no such part."""
    exact: bool = False
    """Whether theory says that the image stays the same: only the tracing differs."""
    kind: str = ""
    """Of those of the same kind a model has one at most; empty: any number."""

    def applied(self, document: Document) -> Document:
        """A simpler document; the given one stays as it is."""
        copy = deepcopy(document)
        self.edit(copy)
        return copy


def objects(value: Any) -> Iterator[Document]:
    """All JSON objects in a value, itself included. Without recursion, for any depth."""
    waiting = [value]
    while waiting:
        found = waiting.pop()
        if isinstance(found, dict):
            yield found
            waiting.extend(found.values())
        elif isinstance(found, list):
            waiting.extend(found)


def assets_of(value: Any) -> set[str]:
    """The files that a document names, or their digests, as it writes them."""
    return {each["asset"] for each in objects(value) if isinstance(each.get("asset"), str)}


def member_lists(document: Document) -> Iterator[list[Document]]:
    """The lists that hold surfaces, and instances in groups."""
    yield document.get("surfaces", [])
    yield from document.get("groups", {}).values()
