"""XML of photometric files as a tree whose elements know their lines."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from nocturne_scene.photometry.intensities import BadPhotometryError
from nocturne_scene.xml_events import XmlError, XmlReader

MAX_BYTES = 64 * 2**20
"""A value of each of a million directions has some 50 bytes."""

_MAX_DEPTH = 32
_MAX_ELEMENTS = 2**21
_MAX_TEXT = 2**25
# Some files say 1.1, which is XML 1.0 but for characters that no number has.
_VERSION_1_1 = re.compile(rb"""(\s*<\?xml\s+version\s*=\s*["']1\.)1(?=["'])""")


@dataclass
class Element:
    """One XML element."""

    tag: str
    """Without a namespace."""
    attributes: dict[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)
    """Of its text."""

    @property
    def text(self) -> str:
        """Without blanks around it."""
        return "".join(self.parts).strip()

    def all(self, *path: str) -> Iterator["Element"]:
        """Those at a path below it, in order."""
        first, *further = path
        for child in self.children:
            if child.tag == first:
                yield from child.all(*further) if further else (child,)

    def first(self, *path: str) -> "Element | None":
        """The first of these."""
        return next(self.all(*path), None)

    def text_at(self, *path: str) -> str:
        """Of the first of these; empty where there is none."""
        found = self.first(*path)
        return "" if found is None else found.text


def is_xml(data: bytes) -> bool:
    """Whether a file begins as XML does."""
    start = data[:512].removeprefix(b"\xef\xbb\xbf")
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        start = start[2:].replace(b"\0", b"")
    return start.lstrip().startswith(b"<")


def parse(data: bytes) -> Element:
    """The root. Raises BadPhotometryError for files that are no XML or may be harmful."""
    if len(data) > MAX_BYTES:
        raise BadPhotometryError(1, f"the file has {len(data)} bytes; at most {MAX_BYTES} are accepted")
    builder = _Builder()
    try:
        builder.feed([_VERSION_1_1.sub(rb"\g<1>0", data, count=1)])
    except XmlError as error:
        raise BadPhotometryError(error.line, str(error)) from None
    if builder.root is None:
        raise BadPhotometryError(1, "is no XML: no element found")
    return builder.root


class _Builder(XmlReader):
    def __init__(self) -> None:
        super().__init__(_MAX_DEPTH, namespaces=True)
        self.root: Element | None = None
        self._open: list[Element] = []
        self._elements = self._characters = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._elements += 1
        if self._elements > _MAX_ELEMENTS:
            self.refuse(f"has more than {_MAX_ELEMENTS} elements")
        named = {_local(name): value for name, value in attributes.items()}
        element = Element(_local(tag), named, self.line)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def end(self) -> None:
        self._open.pop()

    def text(self, text: str) -> None:
        self._characters += len(text)
        if self._characters > _MAX_TEXT:
            self.refuse(f"has more than {_MAX_TEXT} characters of text")
        self._open[-1].parts.append(text)


def _local(name: str) -> str:
    return name.rpartition("}")[2]
