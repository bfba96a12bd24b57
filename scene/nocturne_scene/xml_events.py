"""XML as events whose lines are known, for readers of files from anywhere.

A document type is refused: entities are declared there and nowhere else, so that none grows or names a file.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import NoReturn
from xml.parsers.expat import ExpatError, ParserCreate, errors


class XmlError(Exception):
    """A file is no XML, or may be harmful."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(message)
        self.line = line


class XmlReader(ABC):
    """Gets the parts of one file in order."""

    def __init__(self, max_depth: int, *, namespaces: bool = False) -> None:
        """With `namespaces`, names that have one begin with it and a `}`."""
        self._max_depth = max_depth
        self._depth = 0
        self._parser = ParserCreate(namespace_separator="}" if namespaces else None)
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self.text
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype

    @abstractmethod
    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """An element begins."""

    @abstractmethod
    def end(self) -> None:
        """The last one that has begun and not ended ends."""

    @abstractmethod
    def text(self, text: str) -> None:
        """Text in it."""

    @property
    def line(self) -> int:
        """Where it reads."""
        return self._parser.CurrentLineNumber

    def refuse(self, message: str) -> NoReturn:
        """Raises XmlError at this line."""
        raise XmlError(self.line, message)

    def feed(self, pieces: Iterable[bytes | str]) -> None:
        """Reads a whole file. Raises XmlError."""
        try:
            for piece in pieces:
                self._parser.Parse(piece, False)
            self._parser.Parse(b"", True)
        except ExpatError as error:
            raise XmlError(error.lineno, f"is no XML: {errors.messages.get(error.code)}") from None
        except (ValueError, LookupError) as error:
            # Such as an encoding that Python does not know.
            raise XmlError(self.line, f"has an encoding that can't be read: {str(error)[:200]}") from None

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > self._max_depth:
            self.refuse(f"elements are nested more than {self._max_depth} deep")
        self.start(tag, attributes)

    def _end(self, _: str) -> None:
        self._depth -= 1
        self.end()

    def _refuse_doctype(self, *_: object) -> None:
        self.refuse("declares a document type or entities, of which it has no need")
