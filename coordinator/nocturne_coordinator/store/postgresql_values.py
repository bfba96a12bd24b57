"""PostgreSQL's rows by name or place, its texts and numbers, and statements as the store has them."""

import re
from collections.abc import Iterable, Iterator, Sequence
from decimal import Decimal
from functools import lru_cache
from typing import Any

import psycopg
from psycopg.types.numeric import NumericBinaryLoader
from psycopg.types.string import StrDumper

_CASELESS = 0x20000
"""From this code point on there are no letters with cases."""


class NamedRow:
    """Values by name or place, and in their order."""

    __slots__ = ("_places", "_values")

    def __init__(self, places: dict[str, int], values: Sequence[Any]) -> None:
        self._places, self._values = places, values

    def __getitem__(self, key: str | int, /) -> Any:
        return self._values[key if isinstance(key, int) else self._places[key]]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._values)

    def keys(self) -> Iterable[str]:
        return self._places.keys()


def rows_of(cursor: "psycopg.Cursor[Any] | psycopg.RawCursor[Any]") -> Any:
    places = {column.name: place for place, column in enumerate(cursor.description or ())}
    return lambda values: NamedRow(places, values)


class Words(StrDumper):
    """PostgreSQL's texts have no zero bytes; a worker's message may."""

    def dump(self, obj: str) -> Any:
        return super().dump(obj.replace("\0", "\ufffd") if "\0" in obj else obj)


class Number(NumericBinaryLoader):
    """Sums of whole numbers are whole numbers."""

    def load(self, data: Any) -> Any:
        number: Decimal = super().load(data)
        return int(number) if number.as_tuple().exponent == 0 else float(number)


@lru_cache(maxsize=1024)
def numbered(statement: str) -> bytes:
    """`?` and `?2` as PostgreSQL has them, `$1` and `$2`."""
    count = 0

    def place(found: "re.Match[str]") -> str:
        nonlocal count
        count += 1
        return f"${found[1] or count}"

    return re.sub(r"\?(\d*)", place, statement).encode()


def casefold() -> str:
    """Python's str.casefold as a function, as people search in words of any alphabet."""
    folds = {chr(code): chr(code).casefold() for code in range(_CASELESS)}
    one = {each: fold for each, fold in folds.items() if fold != each and len(fold) == 1}
    folded = "$1"
    for each, fold in folds.items():
        if len(fold) > 1:
            folded = f"replace({folded}, '{each}', '{fold}')"
    return f"""CREATE FUNCTION casefold(text) RETURNS text LANGUAGE sql IMMUTABLE AS $function$
        SELECT CASE WHEN octet_length($1) = length($1) THEN lower($1 COLLATE "C")
        ELSE translate({folded}, '{"".join(one)}', '{"".join(one.values())}') END $function$"""
