"""Watching through both endpoints."""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_api.service import Service
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services import coordinator_acts

Stub = render_service_pb2_grpc.RenderServiceStub


async def _create(rest: httpx.AsyncClient, body: dict[str, Any]) -> str:
    return str((await rest.post("/v1/renders", json=body)).json()["id"])


async def test_events_until_the_end(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = await _create(rest, body)
    states: list[dict[str, Any]] = []
    ids: list[int] = []
    async with rest.stream("GET", f"/v1/renders/{render_id}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        async for line in stream.aiter_lines():
            if line.startswith("id: "):
                ids.append(int(line[4:]))
            if line.startswith("data: "):
                states.append(json.loads(line[6:]))
                if len(states) == 1:
                    coordinator_acts.progress(folder, render_id, 1200)
                elif len(states) == 2:
                    coordinator_acts.finish(folder, render_id)
    assert [state["state"] for state in states] == ["QUEUED", "RUNNING", "SUCCEEDED"]
    assert states[1]["progress"]["mean_samples"] == 1.0
    assert ids == [state["sequence"] for state in states]

    path = f"/v1/renders/{render_id}/events"
    assert (await rest.get(path, headers={"Last-Event-ID": str(ids[-1])})).status_code == 204
    again = await rest.get(path, headers={"Last-Event-ID": str(ids[0])})
    assert again.text.count("event: render") == 1


async def test_last_event_id_leaves_out_what_is_known(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = await _create(rest, body)
    sequence = (await rest.get(f"/v1/renders/{render_id}")).json()["sequence"]
    headers = {"Last-Event-ID": str(sequence)}
    async with rest.stream("GET", f"/v1/renders/{render_id}/events", headers=headers) as stream:
        lines = stream.aiter_lines()
        assert (await anext(lines)).startswith(":")
        coordinator_acts.finish(folder, render_id)
        states = [json.loads(line[6:])["state"] async for line in lines if line.startswith("data: ")]
    assert states == ["SUCCEEDED"]


async def test_slow_watchers_get_the_newest_state_only(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = await _create(rest, body)
    call = Stub(channel).WatchRender(pb.WatchRenderRequest(id=render_id))
    states = [(await anext(aiter(call))).state]
    for photons in range(500):
        coordinator_acts.progress(folder, render_id, photons)
    coordinator_acts.finish(folder, render_id)
    states += [render.state async for render in call]
    assert states[-1] == pb.RENDER_STATE_SUCCEEDED
    assert len(states) < 20


async def test_watching_what_is_not_there(rest: httpx.AsyncClient) -> None:
    assert (await rest.get("/v1/renders/none/events")).status_code == 404


async def test_all_renders_are_watched_together(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    first = await _create(rest, body)
    seen: list[tuple[str, str]] = []
    async with rest.stream("GET", "/v1/events") as stream:
        second = ""
        async for line in stream.aiter_lines():
            if not line.startswith("data: "):
                continue
            render = json.loads(line[6:])
            seen.append((render["id"], render["state"]))
            if len(seen) == 1:
                second = await _create(rest, {**body, "request_id": "second"})
            elif len(seen) == 2:
                coordinator_acts.finish(folder, first)
            else:
                break
    assert seen == [(first, "QUEUED"), (second, "QUEUED"), (first, "SUCCEEDED")]


async def test_stopping_ends_all_streams(
    body: dict[str, Any], rest: httpx.AsyncClient, service: Service
) -> None:
    render_id = await _create(rest, body)
    async with rest.stream("GET", f"/v1/renders/{render_id}/events") as stream:
        lines = stream.aiter_lines()
        await anext(lines)
        async with asyncio.timeout(5):
            await service.end_streams()
            rest_of_it = [line async for line in lines]
    assert any(render_id in line for line in rest_of_it)


async def test_a_silent_stream_is_kept_alive(
    body: dict[str, Any], rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fastapi.routing._PING_INTERVAL", 0.05)
    render_id = await _create(rest, body)
    comments: list[str] = []
    async with asyncio.timeout(10), rest.stream("GET", f"/v1/renders/{render_id}/events") as stream:
        async for line in stream.aiter_lines():
            comments += [line] if line.startswith(":") else []
            if len(comments) == 4:
                break
    assert comments == [": watching", ": ping", ": ping", ": ping"]


async def test_a_stream_that_is_left_makes_room(
    body: dict[str, Any], rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCHERS", 1)
    await _create(rest, body)

    async def second_line() -> str:
        async with rest.stream("GET", "/v1/events") as stream:
            lines = [line async for line in _first(stream, 2)]
        return lines[1]

    async with asyncio.timeout(10):
        for _ in range(3):
            while await second_line() != "event: render":
                pass  # The service has not noticed yet that the one before is gone.


async def _first(stream: httpx.Response, number: int) -> AsyncIterator[str]:
    """The first lines that are not empty."""
    async for line in stream.aiter_lines():
        if line:
            yield line
            number -= 1
        if number == 0:
            return


async def test_numbers_of_thousands_of_digits_are_refused(
    rest: httpx.AsyncClient, body: dict[str, Any]
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    long = "9" * 5000
    for path, headers in (
        ("events", {"Last-Event-ID": long}),
        (f"tiles?since={long}.0", {}),
        (f"tiles?since=1.{long}", {}),
    ):
        answer = await rest.get(f"/v1/renders/{render_id}/{path}", headers=headers)
        assert answer.status_code == 422, path
