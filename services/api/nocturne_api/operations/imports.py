"""Imports: scenes of other renderers become scene documents."""

import asyncio
from pathlib import Path
from tempfile import TemporaryDirectory

from nocturne_scene.errors import InputError

from nocturne_api.access import CALLER
from nocturne_api.importing.pool import import_in_child
from nocturne_api.limits import IMPORT_FILES
from nocturne_api.models.imports import ImportedScene, ImportRequest
from nocturne_api.operations.assets import Assets
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.submission import digest_problems, raise_if


class Imports:
    """Some imports at a time, each in a child process of low priority."""

    def __init__(self, access: FolderAccess, assets: Assets) -> None:
        self._access = access
        self._blobs = access.folder.blobs
        self._assets = assets

    async def run(self, request: ImportRequest) -> ImportedScene:
        """The scene document, whose files are stored as the caller's; takes up to minutes.

        Raises InputError with every problem found, QuotaUsedUp, FolderFull, and Overloaded while others run.
        """
        async with self._access.recorded("import"):
            CALLER.get().need("submit")
            return await self._run(request)

    async def _run(self, request: ImportRequest) -> ImportedScene:
        if not 1 <= len(request.files) <= IMPORT_FILES:
            raise InputError.at("$.files", f"expected 1 to {IMPORT_FILES}, found {len(request.files)}")
        raise_if(
            problem
            for name, sha256 in request.files.items()
            for problem in digest_problems(sha256, f"$.files[{name[:100]!r}]")
        )
        folder = await asyncio.to_thread(TemporaryDirectory, prefix="nocturne-import-")
        try:
            place = {"folder": folder.name, "blobs": str(self._blobs.root)}
            remote = self._blobs.remote and self._blobs.remote.url
            answer = await import_in_child({**request.model_dump(), **place, "objects": remote})
            await self._assets.adopt({sha256: Path(file) for sha256, file in answer.pop("files").items()})
        finally:
            await asyncio.to_thread(folder.cleanup)
        return ImportedScene.model_validate(answer)
