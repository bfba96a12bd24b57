"""The primitives of Radiance files, in their order."""

from collections.abc import Iterator
from dataclasses import dataclass

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.findings import Findings

_MOST = 5_000_000
"""Words of a file."""


@dataclass(frozen=True)
class Primitive:
    """`modifier type name`, and its arguments."""

    modifier: str
    kind: str
    name: str
    texts: tuple[str, ...]
    numbers: tuple[float, ...]
    place: str
    """Of the file and line."""

    def need(self, count: int) -> tuple[float, ...]:
        """Its numbers, which are so many. Raises InputError."""
        if len(self.numbers) != count:
            found = len(self.numbers)
            raise InputError.at(
                self.place, f"{self.kind} {self.name}: expected {count} numbers, found {found}"
            )
        return self.numbers


def primitives(text: str, shown: str, findings: Findings) -> Iterator[Primitive]:
    """Raises InputError with the line."""
    words = _words(text, shown, findings)
    for word, place in words:
        modifier = word
        kind, name = (_next(words, place, "a type and a name") for _ in range(2))
        if kind == "alias":
            yield Primitive(modifier, kind, name, (_next(words, place, "a name"),), (), place)
            continue
        texts = tuple(_next(words, place, "a text") for _ in range(_count(words, place, f"{kind} {name}")))
        for _ in range(_count(words, place, f"{kind} {name}")):
            _next(words, place, "an integer")
        count = _count(words, place, f"{kind} {name}")
        numbers = tuple(_number(_next(words, place, "a number"), place) for _ in range(count))
        yield Primitive(modifier, kind, name, texts, numbers, place)


def _words(text: str, shown: str, findings: Findings) -> Iterator[tuple[str, str]]:
    """With the line that each is in; comments and commands are left out."""
    found, continued = 0, False
    for number, line in enumerate(text.splitlines(), start=1):
        place = f"{shown}, line {number}"
        if continued or line.lstrip().startswith("!"):
            if not continued:
                said = f"the command {line.strip()[:80]} is not run; write what it prints into the file"
                findings.lost(place, said)
            continued = line.rstrip().endswith("\\")
            continue
        for word in line.partition("#")[0].split():
            found += 1
            if found > _MOST:
                raise InputError.at(place, f"more than {_MOST:,} words")
            yield word, place


def _next(words: Iterator[tuple[str, str]], place: str, what: str) -> str:
    word, _ = next(words, ("", ""))
    if not word:
        raise InputError.at(place, f"the file ends where {what} is expected")
    return word


def _count(words: Iterator[tuple[str, str]], place: str, of: str) -> int:
    word = _next(words, place, "a number of arguments")
    if not word.isascii() or not word.isdigit() or int(word) > _MOST:
        raise InputError.at(place, f"{of}: expected a number of arguments, found {word[:40]!r}")
    return int(word)


def _number(word: str, place: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError.at(place, f"expected a number, found {word[:40]!r}") from None
