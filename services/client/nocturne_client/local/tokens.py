"""API tokens of a data folder on this machine."""

import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.errors import NocturneError

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.data import default_data_folder


def create_token(data: Path | None, name: str, scopes: Sequence[str], weight: int) -> str:
    """The new token's secret."""
    with _folder(data) as folder:
        return folder.tokens.create(name, scopes, weight)


def first_token(data: Path) -> str | None:
    """The secret of an admin's token, where nobody could get in otherwise; None where somebody can."""
    with _folder(data) as folder:
        if any(not token.revoked for token in folder.tokens.list()):
            return None
        return folder.tokens.create(f"admin-{secrets.token_hex(3)}", ["admin"])


def list_tokens(data: Path | None) -> list[dict[str, Any]]:
    """The stored facts of each, oldest first."""
    with _folder(data) as folder:
        return [asdict(token) for token in folder.tokens.list()]


def revoke_token(data: Path | None, name: str) -> None:
    """Lets nobody in with it any more."""
    with _folder(data) as folder:
        folder.tokens.revoke(name)


@contextmanager
def _folder(data: Path | None) -> Iterator[DataFolder]:
    try:
        folder = DataFolder(data or default_data_folder())
        try:
            yield folder
        finally:
            folder.close()
    except NocturneError as error:
        raise NocturneClientError(str(error)) from error
