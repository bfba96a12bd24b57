"""XML as elements; those that a scene may have a million of are given away as soon as they end."""

import json
import math
import os
import re
import tempfile
import weakref
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nocturne_scene.errors import InputError
from nocturne_scene.texts import text_of
from nocturne_scene.xml_events import XmlError, XmlReader

# How deep elements may nest.
_MAX_DEPTH = 64
# Of a file, which is read in pieces: a million shapes have some 300 MB.
_MAX_BYTES = 2**30
_PIECE_BYTES = 2**20
# A declaration of an encoding other than UTF-8 and UTF-16.
_OTHER_ENCODING = re.compile(rb"""\s*<\?xml[^>]*\sencoding\s*=\s*["'](?!utf-?8|utf-?16)""", re.IGNORECASE)
_HEAD_BYTES = 256
_SEPARATORS = re.compile(r"[\s,]+")

# Numbers of one value: far more than a matrix has, as many as a table of 1 nm has.
_MAX_NUMBERS = 20_000


@dataclass
class Element:
    """One XML element; `place` names file and line."""

    tag: str
    attributes: dict[str, str]
    place: str
    children: list["Element"] = field(default_factory=list)
    number: int = -1
    """Of the elements of a scene, in the order in which they end; a packed element keeps its number."""
    packed: list[int] = field(default_factory=list)
    """More children, which lie in a file."""

    @property
    def type(self) -> str:
        """The plugin's name."""
        return self.attributes.get("type", "")

    @property
    def name(self) -> str:
        """The parameter that it is for."""
        return self.attributes.get("name", "")

    @property
    def id(self) -> str:
        """What references call it."""
        return self.attributes.get("id", "")

    def need(self, attribute: str) -> str:
        """Return an attribute; InputError without it."""
        if attribute not in self.attributes:
            raise InputError.at(self.place, f'<{self.tag}> needs the attribute "{attribute}"')
        return self.attributes[attribute]


class Packed:
    """Elements in a temporary file; of each in memory only where it is."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - open for as long as this
        weakref.finalize(self, self._file.close)
        self._ends = array("Q", [0])

    def add(self, element: Element) -> int:
        """Return the element's index."""
        content = json.dumps(_plain(element)).encode()
        self._file.write(content)
        self._ends.append(self._ends[-1] + len(content))
        return len(self._ends) - 2

    def __getitem__(self, index: int) -> Element:
        start, end = self._ends[index : index + 2]
        self._file.flush()
        return _element(json.loads(os.pread(self._file.fileno(), end - start, start)))


def _plain(element: Element) -> list[Any]:
    inner = [_plain(child) for child in element.children]
    return [element.tag, element.attributes, element.place, inner, element.number]


def _element(plain: list[Any]) -> Element:
    tag, attributes, place, inner, number = plain
    return Element(tag, attributes, place, [_element(child) for child in inner], number)


class _Builder(XmlReader):
    """Builds elements, and remembers their lines."""

    def __init__(self, shown: str, part: "Part") -> None:
        super().__init__(_MAX_DEPTH)
        self.root: Element | None = None
        self._shown = shown
        self._part = part
        self._open: list[Element] = []

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, f"{self._shown}:{self.line}")
        if not self._open:
            self.root = element
        self._open.append(element)

    def end(self) -> None:
        element = self._open.pop()
        if not self._part(element, self._open) and self._open:
            self._open[-1].children.append(element)

    def text(self, text: str) -> None:
        if text.strip():
            self.refuse(f'text "{text.strip()[:40]}" between elements')


Part = Callable[[Element, list[Element]], bool]
"""Told of an element that ended and of those around it, the root first; whether it takes it away from
them."""


def parse_xml(file: Path, shown: str, part: Part) -> None:
    """Read a file. Raises InputError for a file that is no XML or may be harmful."""
    builder = _Builder(shown, part)
    try:
        with file.open("rb") as opened:
            if os.fstat(opened.fileno()).st_size > _MAX_BYTES:
                raise InputError.at(shown, f"has more than {_MAX_BYTES:,} bytes")
            other = _OTHER_ENCODING.match(opened.read(_HEAD_BYTES))
            opened.seek(0)
            # Text that says nothing of its encoding is read as Mitsuba does, whatever bytes are in it.
            source = opened if other else text_of(opened)
            builder.feed(iter(lambda: source.read(_PIECE_BYTES), b"" if other else ""))
    except OSError as error:
        raise InputError.at(shown, f"can't be read: {error.strerror}") from None
    except XmlError as error:
        raise InputError.at(f"{shown}:{error.line}", str(error)) from None
    if builder.root is None:
        raise InputError.at(shown, "is empty")


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


def hexadecimal(element: Element) -> list[float] | None:
    """Red, green and blue of #rrggbb, 1 being the largest; None for another form. Raises InputError."""
    text = element.need("value").strip()
    if not text.startswith("#") or len(text) != 7:
        return None
    try:
        return [int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    except ValueError:
        raise InputError.at(element.place, f'expected six hexadecimal digits, found "{text}"') from None
