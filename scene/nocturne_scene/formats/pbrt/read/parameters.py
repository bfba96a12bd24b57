"""The parameters of one directive, read by type; parameters that are left over are reported."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.tokens import Token
from nocturne_scene.formats.reading.findings import Findings

_T = TypeVar("_T")

_NUMBERS = ("float", "integer", "rgb", "blackbody", "normal", "normal3")
# Of pbrt-v3 alone.
_OLD = ("color", "xyz")
_VECTORS = ("point", "point2", "point3", "vector", "vector2", "vector3")
_WORDS = ("string", "texture", "bool", "spectrum")
# In letters of either case, as programs in Python write them.
_SWITCHES = ("true", "false")


@dataclass(frozen=True)
class Parameter:
    """A value with its type and name."""

    type: str
    name: str
    values: list[float] | list[str]
    place: str

    def numbers(self, *counts: int) -> list[float]:
        """The values as numbers, as many as one of `counts` if given."""
        values = self.values
        if any(isinstance(value, str) for value in values):
            raise InputError.at(self.place, f'"{self.name}" is numbers')
        if counts and len(values) not in counts:
            expected = " or ".join(str(count) for count in counts)
            raise InputError.at(self.place, f'"{self.name}" has {len(values)} numbers; expected {expected}')
        return [float(value) for value in values]

    def word(self) -> str:
        """The value as one string."""
        if len(self.values) != 1 or not isinstance(self.values[0], str):
            raise InputError.at(self.place, f'"{self.name}" is one string')
        return self.values[0]


def _numbers(token: Token) -> list[float]:
    """A token as finite numbers. Raises InputError."""
    try:
        values = [float(word) for word in token.text.split()]
    except ValueError:
        values = [math.nan]
    if token.kind not in ("word", "numbers") or not all(math.isfinite(value) for value in values):
        raise InputError.at(token.place, f'expected a number, found "{token.text[:40]}"')
    return values


class Stream:
    """Tokens with one looked at ahead."""

    def __init__(self, tokens: Iterator[Token]) -> None:
        self._tokens = tokens
        self.ahead = next(tokens, None)

    def take(self, place: str) -> Token:
        """The next token; InputError at the end of the file."""
        if self.ahead is None:
            raise InputError.at(place, "the file ends in the middle of this directive")
        token, self.ahead = self.ahead, next(self._tokens, None)
        return token

    def string(self, place: str) -> str:
        """A string."""
        token = self.take(place)
        if token.kind != "string":
            raise InputError.at(token.place, f'expected a string in quotes, found "{token.text[:40]}"')
        return token.text

    def numbers(self, count: int, place: str) -> list[float]:
        """As many numbers, with or without brackets."""
        bracket = self.ahead is not None and self.ahead.kind == "open"
        if bracket:
            self.take(place)
        values: list[float] = []
        while len(values) < count:
            values += _numbers(self.take(place))
        if len(values) > count or (bracket and self.take(place).kind != "close"):
            raise InputError.at(place, f"expected {count} numbers")
        return values

    def parameters(self, place: str) -> "list[Parameter]":
        """All parameters that follow."""
        found = []
        while self.ahead is not None and self.ahead.kind == "string":
            declared = self.take(place)
            kind, name = [*declared.text.split(), "", ""][:2]
            if not name or kind not in (*_NUMBERS, *_OLD, *_VECTORS, *_WORDS):
                raise InputError.at(declared.place, f'expected "type name", found "{declared.text[:60]}"')
            found.append(Parameter(kind, name, self._values(kind, declared.place), declared.place))
        return found

    def _values(self, kind: str, place: str) -> list[float] | list[str]:
        first = self.take(place)
        listed = [first]
        if first.kind == "open":
            listed = []
            while (token := self.take(place)).kind != "close":
                listed.append(token)
        is_table = kind == "spectrum" and listed and listed[0].kind in ("word", "numbers")
        if kind not in _WORDS or is_table:
            return [value for token in listed for value in _numbers(token)]
        for token in listed:
            if token.kind != "string" and not (kind == "bool" and token.text.lower() in _SWITCHES):
                raise InputError.at(token.place, f'expected a string in quotes, found "{token.text[:40]}"')
        return [token.text for token in listed]


class Parameters:
    """The parameters of a plugin; each can be taken once."""

    def __init__(self, what: str, place: str, given: list[Parameter], findings: Findings) -> None:
        self.what, self.place = what, place
        self._findings = findings
        # Where a name is given twice, the later one holds: defaults of `Attribute` come first.
        self._named = {parameter.name: parameter for parameter in given}

    def take(self, name: str) -> Parameter | None:
        """A parameter; None without it."""
        return self._named.pop(name, None)

    def has(self, name: str) -> bool:
        """Whether a parameter is there and not taken yet."""
        return name in self._named

    def number(self, name: str, default: _T) -> float | _T:
        """A number."""
        found = self.take(name)
        return default if found is None else found.numbers(1)[0]

    def whole(self, name: str, default: int) -> int:
        """A whole number."""
        return int(self.number(name, default))

    def word(self, name: str, default: _T) -> str | _T:
        """A string."""
        found = self.take(name)
        return default if found is None else found.word()

    def switch(self, name: str, default: bool) -> bool:
        """True or false."""
        found = self.take(name)
        if found is None:
            return default
        if found.word().lower() not in _SWITCHES:
            raise InputError.at(found.place, f'"{name}" is true or false')
        return found.word().lower() == "true"

    def numbers(self, name: str, *counts: int) -> list[float] | None:
        """A list of numbers; None without it."""
        found = self.take(name)
        return None if found is None else found.numbers(*counts)

    def rename(self, prefix: str) -> None:
        """Leave out a prefix where names have it."""
        self._named = {name.removeprefix(prefix): each for name, each in self._named.items()}

    def ignore(self, *names: str) -> None:
        """Take parameters that don't change what an image converges to."""
        for name in names:
            self.take(name)

    def ignore_all(self) -> None:
        """Take all that is left."""
        self._named.clear()

    def finish(self) -> None:
        """Tell of everything that was not taken."""
        for parameter in self._named.values():
            self._findings.lost(
                parameter.place, f'{self.what}: no support for the parameter "{parameter.name}"'
            )
