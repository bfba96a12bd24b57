"""Imports of other renderers' scenes, and preflights, which say what a scene needs."""

import asyncio
import hashlib
import json
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from nocturne_scene.blobs import NoteKey
from nocturne_scene.errors import InputError

from nocturne_api.access import CALLER
from nocturne_api.children.pools import import_in_child, preflight_in_child
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.errors import Overloaded
from nocturne_api.limits import IMPORT_FILES, IMPORT_KEPT_S
from nocturne_api.models.scenes import ImportedScene, ImportRequest, PreflightReport, PreflightRequest
from nocturne_api.operations.assets import Assets
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.submission import digest_problems, raise_if

_IMPORTERS = 2
"""Number of what importers make of scenes; raised when that changes, since answers are kept."""


class Imports:
    """Some imports at a time, each in a child process of low priority."""

    def __init__(self, access: FolderAccess, assets: Assets) -> None:
        self._access = access
        self._blobs = access.folder.blobs
        self._assets = assets
        self._running: dict[NoteKey, asyncio.Task[ImportedScene]] = {}

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
        key = _key(CALLER.get().name, request)
        kept = await asyncio.to_thread(self._kept, key)
        if kept is not None:
            return kept
        if key not in self._running:
            task = asyncio.create_task(self._import(request, key))
            self._running[key] = task
            task.add_done_callback(lambda done: self._forget(key, done))
        return await asyncio.shield(self._running[key])

    def _forget(self, key: NoteKey, done: "asyncio.Task[ImportedScene]") -> None:
        del self._running[key]
        if not done.cancelled():
            done.exception()  # Whoever still waits has it, too; without one it would be logged as lost.

    def _kept(self, key: NoteKey) -> ImportedScene | None:
        """The answer of the last day, if its files are still stored."""
        note = self._blobs.note(key)
        if note is None:
            return None
        kept = json.loads(note)
        if time.time() - kept["at"] > IMPORT_KEPT_S:
            return None
        for sha256 in kept["files"]:
            self._blobs.touch(sha256)
            if not self._blobs.has(sha256):
                return None
        return ImportedScene.model_validate(kept["answer"])

    async def _import(self, request: ImportRequest, key: NoteKey) -> ImportedScene:
        folder = await asyncio.to_thread(TemporaryDirectory, prefix="nocturne-import-")
        try:
            place = {"folder": folder.name, "blobs": str(self._blobs.root)}
            remote = self._blobs.remote and self._blobs.remote.url
            answer = await import_in_child({**request.model_dump(), **place, "objects": remote})
            files = answer.pop("files")
            await self._assets.adopt({sha256: Path(file) for sha256, file in files.items()})
        finally:
            await asyncio.to_thread(folder.cleanup)
        note = json.dumps({"at": time.time(), "files": sorted(files), "answer": answer})
        await asyncio.to_thread(self._blobs.put_note, key, note)
        return ImportedScene.model_validate(answer)


def _key(owner: str, request: ImportRequest) -> NoteKey:
    """Of the same caller and the same request; kept with one of its files."""
    asked = json.dumps(request.model_dump(), sort_keys=True)
    first = min(request.files.values())
    return NoteKey(first, f"import {_IMPORTERS} {owner} {hashlib.sha256(asked.encode()).hexdigest()}")


class Preflights:
    """One preflight at a time, each in a child process of low priority."""

    def __init__(self, access: FolderAccess, compile_limits: CompileLimits) -> None:
        self._blobs = access.folder.blobs
        self._compile_limits = compile_limits
        self._running = asyncio.Lock()

    async def run(self, request: PreflightRequest) -> PreflightReport:
        """What a scene needs for a target error; takes minutes.

        Raises InputError with every problem found, PreflightFailed, and Overloaded while another one runs.
        """
        CALLER.get().need("submit")
        if self._running.locked():
            raise Overloaded("another preflight is running; try again in a few minutes")
        async with self._running:
            report = await preflight_in_child(request, self._blobs, self._compile_limits)
            return PreflightReport.model_validate(report)
