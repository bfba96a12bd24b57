"""Tokens: who calls."""

from nocturne_api.access import Caller, caller_of
from nocturne_api.operations.folder_access import FolderAccess


class Tokens:
    """The API tokens of one data folder."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access

    async def identify(self, secret: str) -> Caller:
        """Who has this secret; raises Unauthenticated."""
        return caller_of(await self._access.in_database(self._access.folder.tokens.find, secret))
