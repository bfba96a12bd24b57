"""Throw-away child processes that answer one job: JSON on standard input, JSON on standard output."""

import asyncio
import json
import os
import signal
import sys
from typing import Any

from nocturne_scene.errors import InputError, Problem


async def answer_of(program: tuple[str, ...], job: dict[str, Any], seconds: float) -> dict[str, Any] | None:
    """What a program answers, given as the words after Python's; None where it ended without one.

    Raises InputError for the problems that it names, TimeoutError after `seconds`: then it is ended, with
    all that it started.
    """
    child = await asyncio.create_subprocess_exec(
        *(sys.executable, *program),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        process_group=0,
    )
    try:
        async with asyncio.timeout(seconds):
            said, _ = await child.communicate(json.dumps(job).encode())
    finally:
        if child.returncode is None:
            os.killpg(child.pid, signal.SIGKILL)
            await child.wait()
    if not said:
        return None
    answer: dict[str, Any] = json.loads(said)
    if "problems" in answer:
        raise InputError(Problem(*each) for each in answer["problems"])
    return answer
