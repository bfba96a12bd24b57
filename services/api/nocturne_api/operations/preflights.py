"""Preflights: what scenes need for a target error."""

import asyncio

from nocturne_api.access import CALLER
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.errors import Overloaded
from nocturne_api.models.preflights import PreflightReport, PreflightRequest
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.preflight.pool import preflight_in_child


class Preflights:
    """One preflight at a time, each in a child process of low priority."""

    def __init__(self, access: FolderAccess, compile_limits: CompileLimits) -> None:
        self._blobs = access.folder.blobs
        self._compile_limits = compile_limits
        self._running = asyncio.Lock()

    async def run(self, request: PreflightRequest) -> PreflightReport:
        """What a scene needs for a target error; takes minutes.

        Raises InputError with every problem found, CantPreflight, and Overloaded while another one runs.
        """
        CALLER.get().need("submit")
        if self._running.locked():
            raise Overloaded("another preflight is running; try again in a few minutes")
        async with self._running:
            report = await preflight_in_child(request, self._blobs, self._compile_limits)
            return PreflightReport.model_validate(report)
