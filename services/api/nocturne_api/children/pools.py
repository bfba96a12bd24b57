"""Asks child processes: one function for each kind, with its bounds. Jobs and answers are JSON.

A child that takes too long is ended with all that it started. Some kinds run only a few children at once.
"""

import asyncio
import base64
import json
import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nocturne.v1 import job_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError, NotFound, Problem
from nocturne_scene.ranges import make_schedule

from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.errors import Overloaded, PreflightFailed
from nocturne_api.limits import (
    ANNUAL_WALL_S,
    DENOISE_WALL_S,
    IMPORT_CPU_S,
    IMPORT_MEMORY_BYTES,
    IMPORT_WALL_S,
    IMPORTS_AT_ONCE,
    LEARNED_AT_ONCE,
    LEARNED_WALL_S,
    PICTURE_WALL_S,
    PICTURES_AT_ONCE,
    PICTURES_WAITING,
    PREFLIGHT_BUDGET_S,
    PREFLIGHT_WALL_S,
    REPORT_WALL_S,
)
from nocturne_api.models.scenes import PreflightRequest
from nocturne_api.places import Places

_ANNUAL = ("-m", "nocturne_api.children.annual")
_DENOISE = ("-m", "nocturne_api.children.denoising")
_IMPORT = ("-m", "nocturne_api.children.importing")
_LOOK_UP = ("-m", "nocturne_api.children.learned")
_PREFLIGHT = ("-m", "nocturne_api.children.preflight")
_REPORT = ("-m", "nocturne_api.children.report")
_READ = ("-m", "nocturne_api.children.picture")

_years = Places(1, 4, "years of daylight are being made; try again in a minute")
_reports = Places(1, 4, "reports are being made; try again in a minute")
_imports = Places(IMPORTS_AT_ONCE, 0, f"{IMPORTS_AT_ONCE} scenes are being imported; try again in a minute")
_lookups = Places(LEARNED_AT_ONCE, 0, f"{LEARNED_AT_ONCE} places are being looked up; try again")
_pictures = Places(
    PICTURES_AT_ONCE, PICTURES_WAITING, f"{PICTURES_AT_ONCE} pictures are being read; try again."
)


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


async def denoise_in_child(image: Path, folder: Path) -> None:
    """Writes the files of `children.denoising` into `folder`. Raises NotFound, which says why."""
    try:
        answer = await answer_of(_DENOISE, {"image": str(image), "folder": str(folder)}, DENOISE_WALL_S)
    except TimeoutError:
        raise NotFound(f"the image could not be denoised within {DENOISE_WALL_S:g} s") from None
    if answer is None:
        raise NotFound("the denoiser failed; the service's log says why")
    if "failed" in answer:
        raise NotFound(answer["failed"])


async def year_in_child(job: dict[str, Any], blobs: BlobStore, limits: CompileLimits) -> str:
    """A year of daylight as JSON.

    Raises InputError, NotFound where samples are missing, and Overloaded while others are made or after
    ANNUAL_WALL_S.
    """
    async with _years.one():
        try:
            answer = await answer_of(_ANNUAL, {**job, **_bounds(blobs, limits)}, ANNUAL_WALL_S)
        except TimeoutError:
            raise Overloaded(f"the year was not made within {ANNUAL_WALL_S:g} s") from None
    if answer is None or "failed" in answer:
        raise NotFound("the service's log has more" if answer is None else answer["failed"])
    return str(answer["year"])


async def report_in_child(job: dict[str, Any], blobs: BlobStore, limits: CompileLimits) -> None:
    """Writes a report into the job's folder.

    Raises NotFound, which says why there is none, and Overloaded while others are made or after
    REPORT_WALL_S.
    """
    async with _reports.one():
        try:
            answer = await answer_of(_REPORT, {**job, **_bounds(blobs, limits)}, REPORT_WALL_S)
        except TimeoutError:
            raise Overloaded(f"the report was not made within {REPORT_WALL_S:g} s") from None
    if answer is None or "failed" in answer:
        raise NotFound("the service's log has more" if answer is None else answer["failed"])


async def picture_as_tiles(file: Path, tiles: Path, edge: int) -> None:
    """Writes an image file as `tiles`, squares of `edge` pixels, in the layout of `files/tiles.py`.

    Raises InputError for a file that can't be shown, Overloaded where others are being read.
    """
    job = {"file": str(file), "tiles": str(tiles), "edge": edge}
    async with _pictures.one():
        try:
            answer = await answer_of(_READ, job, PICTURE_WALL_S)
        except TimeoutError:
            raise InputError.at("$", f"could not be read within {PICTURE_WALL_S:g} s") from None
    if answer is None:
        raise InputError.at("$", "could not be read within the memory that there is for it")


async def import_in_child(job: dict[str, Any]) -> dict[str, Any]:
    """What the child answers to a job.

    Raises InputError for a scene that can't be imported, or not within the bounds; Overloaded.
    """
    async with _imports.one():
        try:
            answer = await answer_of(_IMPORT, job, IMPORT_WALL_S)
        except TimeoutError:
            raise InputError.at("$.files", f"could not be imported within {IMPORT_WALL_S:g} s") from None
    if answer is None:
        raise InputError.at(
            "$.files",
            f"need more than {IMPORT_CPU_S} s of processor time or {IMPORT_MEMORY_BYTES} bytes of memory; "
            "the service's log has what the importer said, if anything",
        )
    return answer


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
    job = {
        "scene_sha256": place.scene_sha256,
        "schedule": base64.b64encode(place.schedule.SerializeToString()).decode(),
        "x": place.x,
        "y": place.y,
        **_bounds(blobs, limits),
    }
    async with _lookups.one():
        try:
            answer = await answer_of(_LOOK_UP, job, LEARNED_WALL_S)
        except TimeoutError:
            raise Overloaded(f"the scene was not read within {LEARNED_WALL_S:g} s") from None
    if answer is None or "failed" in answer:
        why = "the service's log has more" if answer is None else answer["failed"]
        raise NotFound(f"what was learned can't be looked up: {why}")
    return answer


async def preflight_in_child(
    request: PreflightRequest, blobs: BlobStore, limits: CompileLimits
) -> dict[str, Any]:
    """The report, with the document that is enough.

    Raises InputError, PreflightFailed, and Overloaded after PREFLIGHT_WALL_S.
    """
    problems = list(await asyncio.to_thread(lambda: list(_problems(request))))
    if problems:
        raise InputError(problems)
    try:
        job = {**request.model_dump(), **_bounds(blobs, limits)}
        answer = await answer_of(_PREFLIGHT, job, PREFLIGHT_WALL_S)
    except TimeoutError:
        raise Overloaded(f"the preflight was not made within {PREFLIGHT_WALL_S:g} s") from None
    if answer is None:
        raise PreflightFailed("the preflight ended early; the service's log has more")
    if "failed" in answer:
        raise PreflightFailed(answer["failed"])
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


def _bounds(blobs: BlobStore, limits: CompileLimits) -> dict[str, Any]:
    """Where the files of a scene are, and how much memory the child may have."""
    objects = blobs.remote and blobs.remote.url
    return {"blobs": str(blobs.root), "objects": objects, "memory_bytes": limits.memory_bytes}
