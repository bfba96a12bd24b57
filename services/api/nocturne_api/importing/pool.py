"""Imports scenes in throw-away child processes of low priority; one that takes too long is ended."""

import asyncio
from typing import Any

from nocturne_scene.errors import InputError

from nocturne_api.children import answer_of
from nocturne_api.errors import Overloaded
from nocturne_api.limits import IMPORT_CPU_S, IMPORT_MEMORY_BYTES, IMPORT_WALL_S, IMPORTS_AT_ONCE

_PROGRAM = ("-m", "nocturne_api.importing.child")
_at_once = asyncio.Semaphore(IMPORTS_AT_ONCE)


async def import_in_child(job: dict[str, Any]) -> dict[str, Any]:
    """What the child answers to a job.

    Raises InputError for a scene that can't be imported, or not within the bounds; Overloaded.
    """
    if _at_once.locked():
        raise Overloaded(f"{IMPORTS_AT_ONCE} scenes are being imported; try again in a minute")
    async with _at_once:
        try:
            answer = await answer_of(_PROGRAM, job, IMPORT_WALL_S)
        except TimeoutError:
            raise InputError.at("$.files", f"could not be imported within {IMPORT_WALL_S:g} s") from None
    if answer is None:
        raise InputError.at(
            "$.files",
            f"need more than {IMPORT_CPU_S} s of processor time or {IMPORT_MEMORY_BYTES} bytes of memory; "
            "the service's log has what the importer said, if anything",
        )
    return answer
