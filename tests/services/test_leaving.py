"""Callers that leave leave nothing behind that works on, by either transport; and long work is bounded."""

import asyncio
import json
import os
import random
import subprocess
import time
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_api import limits
from nocturne_api.errors import Overloaded
from nocturne_api.places import Places, to_the_end
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.webhook_receiver import until_true

_NEW = random.SystemRandom().randrange(10**6)


def compiles() -> int:
    """Processes at work for this one, besides the one that makes those that compile."""
    found = subprocess.run(
        ["ps", "-ww", "-eo", "pid,ppid,stat,args"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    rows = [line.split(None, 3) for line in found[1:]]
    servers = {
        pid for pid, parent, _, args in rows if parent == str(os.getpid()) and "compiling.server" in args
    }
    return sum(parent in servers and not stat.startswith("Z") for _, parent, stat, _ in rows)


def slow(scene: dict[str, Any], number: int) -> dict[str, Any]:
    """Takes some twenty seconds of processor time: Mie's theory for droplets that nobody has asked about, on
    this machine, which keeps the tables."""
    fog = {
        f"m{medium}": {
            "droplets": {
                "mode_radius": 1e-5 + (1000 * _NEW + 100 * number + medium) * 2e-16,
                "alpha": 6.0,
                "gamma": 1.0,
                "number": 1e8,
            }
        }
        for medium in range(6)
    }
    return {**scene, "name": f"v{number}", "media": fog, "unbounded_media": [*fog]}


async def test_creates_with_a_short_deadline(
    channel: grpc.aio.Channel, rest: httpx.AsyncClient, scene: dict[str, Any], folder: DataFolder
) -> None:
    """No more compiles than there may be at once, none after the last caller, and others are served."""
    renders = render_service_pb2_grpc.RenderServiceStub(channel)
    most = 0
    for number in range(8):
        request = render_service_pb2.CreateRenderRequest(
            request_id=f"r-{number}",
            scene_json=json.dumps(slow(scene, number)),
            width=8,
            height=8,
            samples=1,
        )
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await renders.CreateRender(request, timeout=0.3)
        assert caught.value.code() in (grpc.StatusCode.DEADLINE_EXCEEDED, grpc.StatusCode.UNAVAILABLE)
        begun = time.monotonic()
        assert (await rest.get("/v1/renders")).json()["renders"] == []
        assert time.monotonic() - begun < 1.0
        most = max(most, compiles())
    assert most <= limits.COMPILES_AT_ONCE
    await until_true(lambda: compiles() == 0, 3.0)
    assert {call["outcome"] for call in folder.calls.last(8)} <= {"BROKEN_OFF"}


async def test_a_create_whose_caller_hangs_up(
    rest: httpx.AsyncClient, body: dict[str, Any], folder: DataFolder
) -> None:
    body["scene"] = slow(body["scene"], 50)
    with pytest.raises(httpx.ReadTimeout):
        await rest.post("/v1/renders", json=body, timeout=1.0)
    await until_true(lambda: compiles() == 0, 3.0)
    await until_true(lambda: bool(folder.calls.last(1)), 3.0)
    assert folder.calls.last(1)[0]["outcome"] == "BROKEN_OFF"
    assert (await rest.get("/v1/renders")).json()["renders"] == []


async def test_places_are_bounded_and_left_with_their_caller() -> None:
    places = Places(1, 1, "try again")
    entered = asyncio.Event()

    async def work() -> None:
        async with places.one():
            entered.set()
            await asyncio.sleep(60)

    first = asyncio.create_task(work())
    await entered.wait()
    second = asyncio.create_task(work())
    await asyncio.sleep(0)
    with pytest.raises(Overloaded, match="try again"):
        await work()
    second.cancel()
    await asyncio.gather(second, return_exceptions=True)
    third = asyncio.create_task(work())
    await asyncio.sleep(0)
    entered.clear()
    first.cancel()
    await asyncio.wait_for(entered.wait(), 1.0)
    third.cancel()
    await asyncio.gather(first, third, return_exceptions=True)
    async with places.one():
        pass


async def test_a_thread_keeps_its_place_until_it_is_over() -> None:
    over = False

    def work() -> None:
        nonlocal over
        time.sleep(0.3)
        over = True

    task = asyncio.create_task(to_the_end(work))
    await asyncio.sleep(0.1)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert over
