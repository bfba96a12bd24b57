"""Preflights scenes in a throw-away child process of low priority, which is ended if it takes too long."""

import asyncio
from collections.abc import Iterator
from typing import Any

from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.ranges import make_schedule

from nocturne_api.children import answer_of
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.errors import CantPreflight, Overloaded
from nocturne_api.limits import PREFLIGHT_BUDGET_S, PREFLIGHT_WALL_S
from nocturne_api.models.preflights import PreflightRequest

_PROGRAM = ("-m", "nocturne_api.preflight.child")


async def preflight_in_child(
    request: PreflightRequest, blobs: BlobStore, limits: CompileLimits
) -> dict[str, Any]:
    """The report, with the document that is enough.

    Raises InputError, CantPreflight, and Overloaded after PREFLIGHT_WALL_S.
    """
    problems = list(await asyncio.to_thread(lambda: list(_problems(request))))
    if problems:
        raise InputError(problems)
    job = {**request.model_dump(), "blobs": str(blobs.root), "objects": blobs.remote and blobs.remote.url}
    job["memory_bytes"] = limits.memory_bytes
    try:
        answer = await answer_of(_PROGRAM, job, PREFLIGHT_WALL_S)
    except TimeoutError:
        raise Overloaded(f"the preflight was not made within {PREFLIGHT_WALL_S:g} s") from None
    if answer is None:
        raise CantPreflight("the preflight ended early; the service's log has more")
    if "failed" in answer:
        raise CantPreflight(answer["failed"])
    return answer


def _problems(request: PreflightRequest) -> Iterator[Problem]:
    if not 0 < request.error < 1:
        yield Problem("$.error", "expected a number between 0 and 1, such as 0.02")
    if not 1 <= request.budget_seconds <= PREFLIGHT_BUDGET_S:
        yield Problem("$.budget_seconds", f"expected 1 to {PREFLIGHT_BUDGET_S:g}")
    for check in (
        lambda: make_schedule(request.width, request.height, 1),
        lambda: check_document(request.scene),
    ):
        try:
            check()
        except InputError as error:
            yield from error.problems
