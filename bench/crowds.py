"""Costs of crowds for other callers: 2,000 watchers, 1,000 gRPC streams, a scene of a million instances. Also
the time until watchers are cut off whose token is revoked."""

import asyncio
import json
import signal
import statistics
import subprocess
import sys
import time
from collections import Counter
from collections.abc import AsyncIterator, Iterator
from contextlib import (
    AbstractAsyncContextManager,
    AsyncExitStack,
    asynccontextmanager,
    closing,
    contextmanager,
)
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import grpc
import httpx
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_api.limits import WATCHERS_OF_OWNER
from nocturne_client import Client
from nocturne_coordinator.store.data_folder import DataFolder

from bench.programs import running_cpu_s
from bench.report import Figures, Row, significant
from bench.running_service import RunningService, running_service
from bench.scenes import CORNELL, Document

AIM_S = 1.0
"""Nobody else waits longer for an answer."""

WATCHERS, STREAMS, EDGE_OF_INSTANCES = 2000, 1000, 1000
"""A million instances are a thousand copies of a row of a thousand."""

_AT_ONCE = 100
_COMPILE_S = 600.0
_STREAMS_OF_CHANNEL = 150
_RENDER = (256, 256, 1_000_000)
_REVOKED = 5
_AFTER_S = 15.0
"""How long each crowd stays when all of it is there."""


def run(quick: bool) -> Figures:
    """Each crowd in turn during a running render, and the render without a crowd."""
    watchers, streams, edge, after_s = (
        (200, 100, 100, 2.0) if quick else (WATCHERS, STREAMS, EDGE_OF_INSTANCES, _AFTER_S)
    )
    figures: Figures = {"watchers": watchers, "streams": streams, "instances": edge * edge}
    with running_service(workers=1, threads=1) as service, Client(service.url) as client:
        client.submit(Path(CORNELL), *_RENDER)
        with _measured(service) as quiet:
            time.sleep(after_s)
        figures["nobody"] = quiet
        for name, crowd in (
            ("watchers", _watching(service, watchers)),
            ("streams", _streaming(service, streams)),
        ):
            with _measured(service) as found:
                figures[f"answers_to_{name}"] = asyncio.run(_held(crowd, after_s))
            figures[f"beside_{name}"] = found
        with _measured(service) as found:
            figures["instances_submit_s"], figures["instances_first_result_s"] = _submitted(
                client, service.url, edge
            )
            time.sleep(after_s)
        figures["beside_instances"] = found
    with (
        running_service(workers=1, threads=1, auth=True) as service,
        Client(service.url, token=service.token) as client,
    ):
        client.submit(Path(CORNELL), *_RENDER)
        figures["shut_out_s"] = significant(asyncio.run(_shut_out(service, 2 if quick else _REVOKED)))
    return figures


def rows(figures: Figures) -> list[Row]:
    """Answers to the crowds, and the waits of other callers."""
    crowds = {
        "nobody": "no crowd",
        "beside_watchers": f"{figures['watchers']:,} watchers",
        "beside_streams": f"{figures['streams']:,} gRPC streams",
        "beside_instances": f"a scene of {figures['instances']:,} instances",
    }
    found = [
        Row(
            f"with {crowd}: wait of another caller, median and longest, s",
            f"{figures[key]['median_s']:.3g}, {figures[key]['longest_s']:.3g}",
            f"at most {AIM_S:g}",
        )
        for key, crowd in crowds.items()
    ]
    # Earlier runs have not measured it.
    if "shut_out_s" in figures:
        found.append(
            Row(
                f"until {WATCHERS_OF_OWNER} watchers with a revoked token are cut off, of twice as many, s",
                f"{figures['shut_out_s']:.3g}",
                f"at most {AIM_S:g}",
            )
        )
    for name in ("watchers", "streams"):
        said = ", ".join(f"{count:,} x {answer}" for answer, count in figures[f"answers_to_{name}"].items())
        found.append(Row(f"answers to {figures[name]:,} {name}", said))
    found.append(
        Row(
            "API with no crowd, watchers, streams, instances: cores; memory at the end, MiB",
            ", ".join(f"{figures[key]['api_cores']:.2g}" for key in crowds)
            + "; "
            + ", ".join(f"{figures[key]['api_mib']:.0f}" for key in crowds),
        )
    )
    found.append(
        Row(
            f"{figures['instances']:,} instances: submit, first result after that, s",
            f"{figures['instances_submit_s']:.3g}, {figures['instances_first_result_s']:.3g}",
        )
    )
    return found


@contextmanager
def _measured(service: RunningService) -> Iterator[Figures]:
    """How long another caller waits meanwhile, and what the API takes."""
    figures: Figures = {}
    words = ["-m", "bench.caller", service.url, _grpc_target(service)]
    api = service.pids["api"]
    with subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE) as process:
        time.sleep(1.0)
        cpu_s, begun = running_cpu_s(api), time.monotonic()
        try:
            yield figures
        finally:
            took, cpu_s = time.monotonic() - begun, running_cpu_s(api) - cpu_s
            mib = _resident_mib(api)
            process.send_signal(signal.SIGTERM)
            said = process.communicate()[0]
    waits: dict[str, list[float]] = json.loads(said)
    figures |= {
        "median_s": significant(statistics.median([each for all_ in waits.values() for each in all_])),
        "longest_s": significant(max(max(all_) for all_ in waits.values())),
        "longest_s_by_call": {name: significant(max(all_)) for name, all_ in waits.items()},
        "calls": sum(len(all_) for all_ in waits.values()),
        "api_cores": significant(cpu_s / took),
        "api_mib": significant(mib),
    }


def _grpc_target(service: RunningService) -> str:
    found: str = json.loads((service.data / "service.json").read_text())["grpc"]
    return found


def _resident_mib(pid: int) -> float:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * 4096 / 2**20


async def _held(crowd: AbstractAsyncContextManager[Counter[str]], after_s: float) -> dict[str, int]:
    """Opens it and stays; gives the answers."""
    async with crowd as answers:
        await asyncio.sleep(after_s)
    return dict(answers)


@asynccontextmanager
async def _watching(service: RunningService, count: int) -> AsyncIterator[Counter[str]]:
    """Streams of events by REST, a hundred at a time."""
    place = urlsplit(service.url)
    call = f"GET /v1/events HTTP/1.1\r\nHost: {place.netloc}\r\n\r\n".encode()
    writers: list[asyncio.StreamWriter] = []

    async def one() -> str:
        try:
            reader, writer = await asyncio.open_connection(place.hostname, place.port)
            writers.append(writer)
            writer.write(call)
            line = await reader.readline()
            return line.split()[1].decode() if line else "closed"
        except OSError:
            return "refused"

    answers: Counter[str] = Counter()
    for first in range(0, count, _AT_ONCE):
        answers.update(await asyncio.gather(*(one() for _ in range(first, min(count, first + _AT_ONCE)))))
    yield answers
    for writer in writers:
        writer.close()


@asynccontextmanager
async def _streaming(service: RunningService, count: int) -> AsyncIterator[Counter[str]]:
    """Streams of all renders by gRPC, on as many connections as it takes."""
    answers: Counter[str] = Counter()
    # Else all channels of a process share connections.
    options = [("grpc.use_local_subchannel_pool", 1)]
    async with AsyncExitStack() as stack:
        calls: list[Any] = []
        for first in range(0, count, _STREAMS_OF_CHANNEL):
            channel = await stack.enter_async_context(
                grpc.aio.insecure_channel(_grpc_target(service), options=options)
            )
            stub = render_service_pb2_grpc.RenderServiceStub(channel)
            calls += [
                stub.WatchRenders(render_service_pb2.WatchRendersRequest())
                for _ in range(first, min(count, first + _STREAMS_OF_CHANNEL))
            ]

        async def one(call: Any) -> str:
            try:
                await call.read()
            except grpc.aio.AioRpcError as error:
                return str(error.code().name)
            return "OK"

        answers.update(await asyncio.gather(*(one(call) for call in calls)))
        yield answers
        for call in calls:
            call.cancel()


async def _shut_out(service: RunningService, times: int) -> float:
    """Seconds from a revocation to the end of the last stream of the token; the longest of so many."""
    longest = 0.0
    with closing(DataFolder(service.data)) as folder:
        async with AsyncExitStack() as stack:
            await _watching_as(service, folder.tokens.create("other", ["read"]), stack)
            for number in range(times):
                token = folder.tokens.create(f"revoked-{number}", ["read"])
                streams = await _watching_as(service, token, stack)
                folder.tokens.revoke(f"revoked-{number}")
                begun = time.monotonic()
                await asyncio.gather(*(stream.aread() for stream in streams))
                longest = max(longest, time.monotonic() - begun)
    return longest


async def _watching_as(service: RunningService, token: str, stack: AsyncExitStack) -> list[httpx.Response]:
    """All the streams of events that one owner may have, of which each has begun."""
    headers = {"Authorization": f"Bearer {token}"}
    client = await stack.enter_async_context(
        httpx.AsyncClient(
            base_url=service.url, headers=headers, trust_env=False, timeout=60.0, limits=httpx.Limits()
        )
    )
    streams = [
        await stack.enter_async_context(client.stream("GET", "/v1/events")) for _ in range(WATCHERS_OF_OWNER)
    ]
    assert all(stream.is_success for stream in streams)  # noqa: S101
    return streams


def _submitted(client: Client, url: str, edge: int) -> tuple[float, float]:
    """Seconds until a scene of edge x edge instances is accepted, and from then to its first result."""
    asked = {
        "request_id": "instances",
        "scene": _instances(edge),
        "width": 64,
        "height": 64,
        "samples": 1_000_000,
    }
    begun = time.monotonic()
    answer = httpx.post(
        f"{url}/v1/renders", json=asked, timeout=_COMPILE_S, trust_env=False
    ).raise_for_status()
    accepted = time.monotonic()
    while client.get(answer.json()["id"]).progress.ranges_done == 0:
        time.sleep(0.2)
    return significant(accepted - begun), significant(time.monotonic() - accepted)


def _instances(edge: int) -> Document:
    """Balls in rows, under a sky: copies of a row, which is copies of a ball."""
    ball = {
        "shape": {"type": "sphere", "centre": [0, 0.3, 0], "radius": 0.3},
        "kernel": {"type": "lambertian", "reflectance": 0.5},
    }
    return {
        "nocturne": 1,
        "groups": {
            "ball": [ball],
            "row": [{"group": "ball", "translate": [number - edge / 2, 0, 0]} for number in range(edge)],
        },
        "instances": [{"group": "row", "translate": [0, 0, float(number)]} for number in range(edge)],
        "sensor": {
            "type": "pinhole",
            "position": [0, 20, -20],
            "look_at": [0, 0, 40],
            "vertical_field_of_view_degrees": 45,
        },
        "environment": {"radiance": {"illuminant": "D65", "luminance": 100}},
    }
