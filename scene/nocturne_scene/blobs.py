"""Content-addressed files: immutable, named by the SHA-256 of their content.

With an object store, a blob is there before it counts as stored, and one that is missing here is fetched.
"""

import hashlib
import os
import re
import shutil
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, NamedTuple, Protocol

from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.limits import MAX_ASSET_BYTES
from nocturne_scene.replacing import replacing, sync

_SHA256 = re.compile(r"[0-9a-f]{64}")
_PIECE_BYTES = 2**20
# Questions to an object store that wait for their answers together.
_AT_ONCE = 16


class RemoteStore(Protocol):
    """Where blobs are kept besides this machine, such as `nocturne_coordinator.store.object_store`."""

    @property
    def url(self) -> str:
        """Its address, for another process."""

    def put(self, name: str, file: Path) -> None:
        """Stores a copy of the file."""

    def size(self, name: str) -> int | None:
        """Bytes; None if there is no such object."""

    def get(self, name: str, file: Path, sha256: str, most_bytes: int) -> None:
        """Fetches an object into a file; NotFound if there is none."""

    def delete(self, name: str) -> None:
        """The object is not there any more."""


class BlobWriter:
    """Takes the bytes of one blob; refuses more than were declared."""

    def __init__(self, file: BinaryIO, size_bytes: int) -> None:
        self._file = file
        self._declared = size_bytes
        self._digest = hashlib.sha256()
        self._written = 0

    def write(self, data: bytes) -> None:
        """Appends bytes; InputError at once when there are more than declared."""
        self._written += len(data)
        if self._written > self._declared:
            raise InputError.at("asset", f"is longer than the declared {self._declared} bytes")
        self._digest.update(data)
        self._file.write(data)

    def verify(self, sha256: str) -> None:
        """InputError unless exactly the declared bytes with this digest were written."""
        if self._written != self._declared:
            raise InputError.at("asset", f"has {self._written} bytes; {self._declared} were declared")
        if self._digest.hexdigest() != sha256:
            raise InputError.at("asset", f"has SHA-256 {self._digest.hexdigest()}; {sha256} was declared")


def check_size(size_bytes: int) -> None:
    """InputError for a size that no blob may have."""
    if not 0 <= size_bytes <= MAX_ASSET_BYTES:
        raise InputError.at("asset", f"has {size_bytes} bytes; expected 0 to {MAX_ASSET_BYTES}")


class NoteKey(NamedTuple):
    """What a note is about."""

    source: str
    """Digest of the blob with which the note goes."""
    text: str


class BlobStore:
    """A folder of blobs: `root/ab/abcdef...`, lower-case hexadecimal. Safe for many processes at once."""

    def __init__(self, root: Path, remote: RemoteStore | None = None, *, durable: bool = True) -> None:
        """With a remote store, every method may raise what the object store raises, too.

        `durable`: stored files survive a power cut; a folder that goes after a render has no need of that.
        """
        self.root = root
        self.remote = remote
        self._durable = durable
        self._incoming = root / "incoming"
        # Not the folder around it: one that was moved away must not be created again.
        root.mkdir(exist_ok=True)
        self._incoming.mkdir(exist_ok=True)

    def path(self, sha256: str) -> Path:
        """The file of a blob; NotFound if it isn't here, InputError if this is no digest."""
        place = self._place(sha256)
        if not place.is_file() and not self._fetched(sha256, place):
            raise NotFound(f"there is no asset sha256:{sha256}; upload it first")
        return place

    def has(self, sha256: str) -> bool:
        """Whether the blob is here, or in the object store; InputError if this is no digest."""
        if self._place(sha256).is_file():
            return True
        return self.remote is not None and self.remote.size(_object_name(sha256)) is not None

    def here(self, sha256: str) -> Path | None:
        """The file of a blob on this machine; None if it isn't here. InputError if this is no digest."""
        place = self._place(sha256)
        return place if place.is_file() else None

    def remove_here(self, sha256: str) -> None:
        """Remove the blob and its notes from this machine. Nobody may need it."""
        self._place(sha256).unlink(missing_ok=True)
        shutil.rmtree(self._notes_of(sha256), ignore_errors=True)

    def remove_there(self, sha256: str) -> None:
        """The blob is not in the object store any more, unless it is here again: somebody needs it."""
        if self.remote is not None and self.here(sha256) is None:
            self.remote.delete(_object_name(sha256))

    def all(self) -> Iterator[str]:
        """The digests of all blobs that are here."""
        for place in self.root.glob("[0-9a-f][0-9a-f]/*"):
            if _SHA256.fullmatch(place.name):
                yield place.name

    def older_than(self, unix_time: float) -> Iterator[str]:
        """The digests of blobs here that nobody stored or asked about since."""
        for sha256 in self.all():
            with suppress(FileNotFoundError):
                if self._place(sha256).stat().st_mtime < unix_time:
                    yield sha256

    def remove_unfinished(self, unix_time: float) -> None:
        """What a crash left behind in mid-write before then."""
        for file in self._incoming.iterdir():
            with suppress(FileNotFoundError):
                if file.stat().st_mtime < unix_time:
                    file.unlink()

    def touch(self, sha256: str) -> None:
        """Somebody asks about the blob, and is going to use it."""
        with suppress(FileNotFoundError):
            os.utime(self._place(sha256))

    def is_whole(self, sha256: str) -> bool:
        """Whether the blob is here and has every bit that it had."""
        if not self.has(sha256):
            return False
        digest = hashlib.sha256()
        with self.path(sha256).open("rb") as file:
            while piece := file.read(_PIECE_BYTES):
                digest.update(piece)
        return digest.hexdigest() == sha256

    def missing(self, sha256s: Iterable[str]) -> list[str]:
        """Those of the digests whose blobs are nowhere, in the order given, each once."""
        wanted = list(dict.fromkeys(sha256s))
        if self.remote is None:
            return [sha256 for sha256 in wanted if not self.has(sha256)]
        with ThreadPoolExecutor(_AT_ONCE) as threads:
            return [
                sha256 for sha256, has in zip(wanted, threads.map(self.has, wanted), strict=True) if not has
            ]

    def size(self, sha256: str) -> int:
        """Bytes; NotFound if it isn't here."""
        return self.path(sha256).stat().st_size

    @contextmanager
    def writer(self, sha256: str, size_bytes: int) -> Iterator[BlobWriter]:
        """Write a blob's bytes inside `with`; at its end it is verified and visible, or gone.

        Raises InputError where size or digest differ from the declared ones, or the size is over the limit.
        """
        place = self._place(sha256)
        check_size(size_bytes)
        with replacing(place, durable=self._durable, folder=self._incoming) as unfinished:
            with unfinished.open("wb") as file:
                writer = BlobWriter(file, size_bytes)
                yield writer
                writer.verify(sha256)
            if self.remote is not None:
                self.remote.put(_object_name(sha256), unfinished)
            place.parent.mkdir(exist_ok=True)
        if self._durable:
            # The folder may be new.
            sync(self.root)

    def put(self, data: bytes) -> str:
        """Stores bytes made here; gives their digest."""
        sha256 = hashlib.sha256(data).hexdigest()
        self.touch(sha256)
        if not self.has(sha256):
            with self.writer(sha256, len(data)) as writer:
                writer.write(data)
        return sha256

    def put_file(self, sha256: str, file: Path) -> None:
        """Stores a copy of a file made here, whose digest is known."""
        self.touch(sha256)
        if self.has(sha256):
            return
        with file.open("rb") as stream, self.writer(sha256, file.stat().st_size) as writer:
            while piece := stream.read(_PIECE_BYTES):
                writer.write(piece)

    def note(self, about: NoteKey) -> str | None:
        """The note about something; None if there is none. On this machine only."""
        try:
            return self._note_place(about).read_text()
        except FileNotFoundError:
            return None

    def put_note(self, about: NoteKey, text: str) -> None:
        """Notes what took long to find out and can be found out again."""
        place = self._note_place(about)
        for folder in (place.parent.parent, place.parent):
            folder.mkdir(exist_ok=True)
        with replacing(place, folder=self._incoming) as unfinished:
            unfinished.write_text(text)

    def _fetched(self, sha256: str, place: Path) -> bool:
        """Whether the blob was in the object store, and is here now."""
        if self.remote is None:
            return False
        place.parent.mkdir(exist_ok=True)
        try:
            self.remote.get(_object_name(sha256), place, sha256, MAX_ASSET_BYTES)
        except NotFound:
            return False
        return True

    def _note_place(self, about: NoteKey) -> Path:
        return self._notes_of(about.source) / hashlib.sha256(about.text.encode()).hexdigest()

    def _notes_of(self, sha256: str) -> Path:
        return self.root / "notes" / sha256

    def _place(self, sha256: str) -> Path:
        if not _SHA256.fullmatch(sha256):
            raise InputError.at("sha256", "expected 64 lower-case hexadecimal digits")
        return self.root / sha256[:2] / sha256


def _object_name(sha256: str) -> str:
    return f"blobs/{sha256[:2]}/{sha256}"
