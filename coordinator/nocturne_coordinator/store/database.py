"""What a data folder's database is to all that use it: statements and transactions, for many processes and
threads.

Statements are of the SQL that SQLite and PostgreSQL have in common. `?` is the next value, `?1` the first.
The few functions of SQLite's that they use are made in PostgreSQL (decision 0190).
"""

import sqlite3
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Any, Protocol

from nocturne_scene.errors import NocturneError

Values = tuple[Any, ...]

DatabaseTrouble = sqlite3.Error
"""What databases raise."""

DatabaseUnavailable = sqlite3.OperationalError
"""What they raise where it may pass: full, locked for too long, not to be written, not to be reached."""


class FolderGone(NocturneError, DatabaseUnavailable):
    """The data folder was moved away, or another one is in its place; it passes when the folder is back."""


class Row(Protocol):
    """One row: values by name or place."""

    def __getitem__(self, key: Any, /) -> Any: ...

    def __iter__(self) -> Iterator[Any]: ...

    def keys(self) -> Iterable[str]:
        """The names of the columns."""
        ...


class FolderLock(ABC):
    """What coordinators hold while they work on a data folder; it ends with their process."""

    @abstractmethod
    def starting(self) -> AbstractContextManager[None]:
        """One at a time is inside, of all that start; they wait for milliseconds."""

    @abstractmethod
    def take(self, alone: bool) -> bool:
        """Holds the folder alone, or together with others that do not; False where somebody is in the way."""

    @abstractmethod
    def share(self) -> None:
        """Lets others in that take it not alone."""

    @abstractmethod
    def owner(self) -> str:
        """Who holds it, for people; empty: not known."""

    @abstractmethod
    def close(self) -> None:
        """Lets go."""


class Database(ABC):
    """The database of a data folder. Raises DatabaseTrouble; where it may pass, DatabaseUnavailable."""

    @abstractmethod
    def read_beside(self, wait_seconds: float) -> None:
        """From here on threads that read wait neither for each other nor for one that writes, and one that
        writes waits so long at most for another process that does."""

    @abstractmethod
    def transaction(self, durable: bool = True) -> AbstractContextManager[None]:
        """Everything executed inside happens, or nothing does; other processes can't write meanwhile.

        `durable`: it survives a power cut, with all that was committed before. Without that it survives the
        end of any process, and does not wait for the disk: for work that can be done again.
        """

    @abstractmethod
    def snapshot(self) -> AbstractContextManager[None]:
        """All that is read inside is of one moment; nobody waits for it."""

    @abstractmethod
    def execute(self, statement: str, values: Values = ()) -> int:
        """Executes one statement, outside a transaction durably; gives the number of rows it changed."""

    @abstractmethod
    def execute_many(self, statement: str, rows: Iterable[Values]) -> None:
        """Executes one statement for each row of values."""

    @abstractmethod
    def rows(self, query: str, values: Values = ()) -> Sequence[Row]:
        """All rows that a query gives. In a transaction it sees the transaction's own writes."""

    @abstractmethod
    def row(self, query: str, values: Values = ()) -> Row | None:
        """The first row, if there is any."""

    @abstractmethod
    def change_counter(self) -> int:
        """Grows whenever any connection of any process commits a change. Cheap: microseconds in SQLite, one
        question to a server."""

    @abstractmethod
    def check_writing(self, wait_seconds: float) -> None:
        """Whether one could write now; changes nothing. Raises DatabaseTrouble, OSError: gone, locked for so
        long, full, or read-only."""

    @abstractmethod
    def check_place(self) -> None:
        """Raises FolderGone where the folder is not that of its path any more: all writes to it would not be
        found again. Microseconds."""

    @abstractmethod
    def lock(self) -> FolderLock:
        """A lock on the folder for one coordinator, not taken yet."""

    @abstractmethod
    def close(self) -> None:
        """Lets go of all connections."""
