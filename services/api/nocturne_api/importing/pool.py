"""Imports scenes in throw-away child processes of low priority; one that takes too long is ended."""

import asyncio
import json
import os
import signal
import sys
from typing import Any

from nocturne_scene.errors import InputError, Problem

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
        child = await asyncio.create_subprocess_exec(
            *(sys.executable, *_PROGRAM),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            process_group=0,
        )
        try:
            async with asyncio.timeout(IMPORT_WALL_S):
                said, _ = await child.communicate(json.dumps(job).encode())
        except TimeoutError:
            raise InputError.at("$.files", f"could not be imported within {IMPORT_WALL_S:g} s") from None
        finally:
            if child.returncode is None:
                # What it started, too.
                os.killpg(child.pid, signal.SIGKILL)
                await child.wait()
    if not said:
        raise InputError.at(
            "$.files",
            f"need more than {IMPORT_CPU_S} s of processor time or {IMPORT_MEMORY_BYTES} bytes of memory; "
            "the service's log has what the importer said, if anything",
        )
    answer: dict[str, Any] = json.loads(said)
    if "problems" in answer:
        raise InputError(Problem(*each) for each in answer["problems"])
    return answer
