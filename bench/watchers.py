"""Cost of watchers for the API: pages that follow one running render, each fetching every tile that
changes."""

import asyncio
import json
import statistics
import time
from dataclasses import dataclass, field
from pathlib import Path

import httpx
from nocturne_client import Client

from bench.programs import running_cpu_s
from bench.report import Figures, Row, significant
from bench.running_service import RunningService, running_service
from bench.scenes import CORNELL

AIM_CORES = 0.25
WATCHERS = 100
THREADS = 2
_EDGE = 512
_SAMPLES = 1_000_000
_WARM_S = 15.0
"""After the first seconds tiles end their ranges one by one: what a night looks like."""


@dataclass
class Seen:
    """What one watcher got."""

    events: int = 0
    bytes: int = 0
    updates: list[float] = field(default_factory=list)
    """When tiles came."""


def run(quick: bool) -> Figures:
    """Watchers join together at the start; the measurement begins when the first seconds are over."""
    watchers, warm_s, seconds = (10, 5.0, 5.0) if quick else (WATCHERS, _WARM_S, 30.0)
    with (
        running_service(workers=1, threads=THREADS) as service,
        Client(service.url) as client,
    ):
        render = client.submit(Path(CORNELL), _EDGE, _EDGE, _SAMPLES)
        figures = asyncio.run(_watch(service, render.id, watchers, warm_s, seconds))
        client.cancel(render.id)
    return {"watchers": watchers, "seconds": seconds, **figures}


def rows(figures: Figures) -> list[Row]:
    """Cores of the API, and how fresh the watchers' images are."""
    many = figures["watchers"]
    return [
        Row(f"cores of the API with {many} watchers", f"{figures['api_cores']:.3g}", f"below {AIM_CORES}"),
        Row("the same in the first seconds", f"{figures['api_cores_at_first']:.3g}"),
        Row("seconds between updates, median", f"{figures['update_s']:.3g}", "at most 1"),
        Row("MB/s to all watchers", f"{figures['megabytes_per_second']:.3g}"),
    ]


async def _watch(
    service: RunningService, render_id: str, watchers: int, warm_s: float, seconds: float
) -> Figures:
    limits = httpx.Limits(max_connections=None, max_keepalive_connections=None)
    seen = [Seen() for _ in range(watchers)]
    async with httpx.AsyncClient(base_url=service.url, timeout=60, limits=limits, trust_env=False) as client:
        api = service.pids["api"]
        start = running_cpu_s(api)
        tasks = [asyncio.create_task(_follow(client, render_id, each)) for each in seen]
        await asyncio.sleep(warm_s)
        warm, begun = running_cpu_s(api), time.monotonic()
        bytes_before = sum(each.bytes for each in seen)
        await asyncio.sleep(seconds)
        took = time.monotonic() - begun
        cores = (running_cpu_s(api) - warm) / took
        sent = sum(each.bytes for each in seen) - bytes_before
        for task in tasks:
            task.cancel()
        ended = await asyncio.gather(*tasks, return_exceptions=True)
    failed = [error for error in ended if not isinstance(error, asyncio.CancelledError)]
    if failed:
        raise RuntimeError(f"{len(failed)} watchers failed: {failed[0]!r}")
    gaps = [
        later - earlier
        for each in seen
        for earlier, later in zip(each.updates, each.updates[1:], strict=False)
        if earlier >= begun
    ]
    return {
        "api_cores": significant(cores),
        "api_cores_at_first": significant((warm - start) / warm_s),
        "update_s": significant(statistics.median(gaps)),
        "megabytes_per_second": significant(sent / took / 1e6),
    }


async def _follow(client: httpx.AsyncClient, render_id: str, seen: Seen) -> None:
    """As the page does: events name what changed, and it is fetched by the cursor."""
    cursor = ""
    async with client.stream("GET", f"/v1/events?render={render_id}", timeout=None) as stream:
        name = ""
        async for line in stream.aiter_lines():
            if line.startswith("event: "):
                name = line.removeprefix("event: ")
            elif line.startswith("data: ") and name == "tiles":
                seen.events += len(json.loads(line[6:])["tiles"])
                cursor = await _fetch(client, render_id, cursor, seen)
                seen.updates.append(time.monotonic())


async def _fetch(client: httpx.AsyncClient, render_id: str, cursor: str, seen: Seen) -> str:
    answer = await client.get(f"/v1/renders/{render_id}/tiles", params={"since": cursor})
    answer.raise_for_status()
    seen.bytes += len(answer.content)
    return answer.headers["etag"].strip('"')
