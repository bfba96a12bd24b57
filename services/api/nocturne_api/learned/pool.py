"""Looks up learned light in throw-away child processes, which are ended if they take too long."""

import asyncio
import base64
from dataclasses import dataclass
from typing import Any

from nocturne.v1 import job_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import NotFound

from nocturne_api.children import answer_of
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.errors import Overloaded
from nocturne_api.limits import LEARNED_AT_ONCE, LEARNED_WALL_S

_PROGRAM = ("-m", "nocturne_api.learned.child")
_at_once = asyncio.Semaphore(LEARNED_AT_ONCE)


@dataclass(frozen=True)
class Place:
    """A pixel of a render."""

    scene_sha256: str
    schedule: job_pb2.RangeSchedule
    x: int
    y: int


async def learned_in_child(place: Place, blobs: BlobStore, limits: CompileLimits) -> dict[str, Any]:
    """What `nocturne-trace --learned-at` writes.

    Raises NotFound where the scene can't be read, Overloaded while others are read or after LEARNED_WALL_S.
    """
    if _at_once.locked():
        raise Overloaded(f"{LEARNED_AT_ONCE} places are being looked up; try again")
    job = {
        "scene_sha256": place.scene_sha256,
        "schedule": base64.b64encode(place.schedule.SerializeToString()).decode(),
        "x": place.x,
        "y": place.y,
        "blobs": str(blobs.root),
        "objects": blobs.remote and blobs.remote.url,
        "memory_bytes": limits.memory_bytes,
    }
    async with _at_once:
        try:
            answer = await answer_of(_PROGRAM, job, LEARNED_WALL_S)
        except TimeoutError:
            raise Overloaded(f"the scene was not read within {LEARNED_WALL_S:g} s") from None
    if answer is None or "failed" in answer:
        why = "the service's log has more" if answer is None else answer["failed"]
        raise NotFound(f"what was learned can't be looked up: {why}")
    return answer
