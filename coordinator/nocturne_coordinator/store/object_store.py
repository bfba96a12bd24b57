"""An object store in addition to the data folder: files by name, in S3 or a compatible store, or in a folder.

Each stored file has a digest, and is checked against it when read: a store that errs is found out at once.
Credentials are those that every S3 program takes: AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_REGION,
AWS_ENDPOINT_URL and so on, from the environment.
"""

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path
from urllib.parse import urlsplit

import obstore
from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.library_words import without_paths
from nocturne_scene.replacing import replacing
from obstore.exceptions import BaseError
from obstore.store import LocalStore, S3Store

from nocturne_coordinator.errors import ObjectDamaged, ObjectStoreUnavailable

_PIECE_BYTES = 8 * 2**20
_TRIES = 4
_PATIENCE = timedelta(seconds=20)


class ObjectStore:
    """Files of one object store. For all threads."""

    def __init__(self, url: str) -> None:
        """`s3://bucket/prefix` or `file:///folder`. InputError for other addresses. Does not connect yet."""
        self.url = url
        self._store = _store_at(url)

    def put(self, name: str, file: Path) -> None:
        """Stores a file under a name, in place of an earlier one. Raises ObjectStoreUnavailable."""
        with _told(name):
            obstore.put(self._store, name, file)
            size = obstore.head(self._store, name)["size"]
        if size != file.stat().st_size:
            raise ObjectDamaged(f"{name} has {size} bytes in the object store, {file.stat().st_size} here")

    def size(self, name: str) -> int | None:
        """Bytes; None where there is no such object. Raises ObjectStoreUnavailable."""
        try:
            with _told(name):
                return obstore.head(self._store, name)["size"]
        except NotFound:
            return None

    def get(self, name: str, file: Path, sha256: str, most_bytes: int) -> None:
        """Writes an object to `file`, which is whole or untouched.

        Raises NotFound, ObjectStoreUnavailable, and ObjectDamaged unless it has this digest and no more
        bytes.
        """
        with replacing(file, durable=True) as unfinished:
            with unfinished.open("wb") as out:
                found = self._copy(name, out.write, most_bytes)
            if found != sha256:
                raise ObjectDamaged(f"{name} has SHA-256 {found} in the object store")

    def delete(self, name: str) -> None:
        """There is no such object any more. Raises ObjectStoreUnavailable."""
        with suppress(NotFound), _told(name):
            obstore.delete(self._store, name)

    def delete_all(self, folder: str) -> None:
        """There is no object any more whose name begins with `folder` and a slash. Raises
        ObjectStoreUnavailable."""
        with _told(folder):
            names = [each["path"] for batch in obstore.list(self._store, f"{folder}/") for each in batch]
        for name in names:
            self.delete(name)

    def _copy(self, name: str, write: Callable[[bytes], object], most_bytes: int) -> str:
        digest = hashlib.sha256()
        with _told(name):
            answer = obstore.get(self._store, name)
            if answer.meta["size"] > most_bytes:
                raise ObjectDamaged(f"{name} has {answer.meta['size']} bytes in the object store")
            for piece in answer.stream(min_chunk_size=_PIECE_BYTES):
                data = bytes(piece)
                digest.update(data)
                write(data)
        return digest.hexdigest()


@contextmanager
def _told(name: str) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise NotFound(f"there is no {name} in the object store") from None
    except BaseError as error:
        # The first line says what; the rest is the answer of the store, and long.
        reason = without_paths(str(error).splitlines()[0]) if str(error) else type(error).__name__
        raise ObjectStoreUnavailable(f"the object store does not take or give {name}: {reason}") from error


def _store_at(url: str) -> LocalStore | S3Store:
    try:
        parts = urlsplit(url)
    except ValueError:
        parts = urlsplit("")
    if parts.scheme == "file" and parts.path.startswith("/") and not parts.netloc:
        return LocalStore(Path(parts.path), mkdir=True)
    if parts.scheme == "s3" and parts.netloc and not parts.query:
        endpoint = os.environ.get("AWS_ENDPOINT_URL") or os.environ.get("AWS_ENDPOINT") or ""
        return S3Store(
            parts.netloc,
            prefix=parts.path.strip("/") or None,
            # The store checks the bytes on their way in by their digest.
            checksum_algorithm="SHA256",
            client_options={
                "allow_http": endpoint.startswith("http://"),
                "timeout": timedelta(minutes=10),
                "connect_timeout": timedelta(seconds=5),
            },
            retry_config={"max_retries": _TRIES, "retry_timeout": _PATIENCE},
        )
    raise InputError.at("objects", f"{url!r}: expected s3://BUCKET/PREFIX or file:///FOLDER")
