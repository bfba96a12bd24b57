"""Renders through both endpoints: create, get, list, cancel, images, convergence, workers."""

import json
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import job_pb2, render_service_pb2_grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services import coordinator_acts

Stub = render_service_pb2_grpc.RenderServiceStub


def _message(body: dict[str, Any]) -> pb.CreateRenderRequest:
    fields = {key: body[key] for key in ("request_id", "name", "width", "height", "samples")}
    return pb.CreateRenderRequest(scene_json=json.dumps(body["scene"], indent=1), **fields)


async def test_two_endpoints_agree(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    created = await rest.post("/v1/renders", json=body)
    assert created.status_code == 201
    render = created.json()
    assert render["state"] == "QUEUED"
    assert (render["width"], render["height"], render["samples"]) == (40, 30, 16)

    message = await Stub(channel).GetRender(pb.GetRenderRequest(id=render["id"]))
    assert message.state == pb.RENDER_STATE_QUEUED
    for name in ("id", "name", "width", "height", "samples", "scene_sha256", "sequence", "created"):
        assert getattr(message, name) == render[name]
    for name, value in render["progress"].items():
        assert getattr(message.progress, name) == value
    listed = await Stub(channel).ListRenders(pb.ListRendersRequest())
    assert [each.id for each in listed.renders] == [
        each["id"] for each in (await rest.get("/v1/renders")).json()["renders"]
    ]


async def test_create_is_idempotent_across_endpoints(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    first = (await rest.post("/v1/renders", json=body)).json()
    assert (await rest.post("/v1/renders", json=body)).json()["id"] == first["id"]
    assert (await Stub(channel).CreateRender(_message(body))).id == first["id"]
    assert len((await rest.get("/v1/renders")).json()["renders"]) == 1


async def test_a_request_id_with_other_content_is_a_conflict(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, tmp_path: Path
) -> None:
    await rest.post("/v1/renders", json=body)
    blobs = sorted((tmp_path / "data" / "blobs").rglob("*"))
    body["scene"]["surfaces"][0]["shape"]["vertices"][0] = [9, 9, 9]
    answer = await rest.post("/v1/renders", json=body)
    assert (answer.status_code, answer.json()["reason"]) == (409, "CONFLICT")
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await Stub(channel).CreateRender(_message(body))
    assert caught.value.code() == grpc.StatusCode.ALREADY_EXISTS
    assert sorted((tmp_path / "data" / "blobs").rglob("*")) == blobs


async def test_pages_are_newest_first_and_complete(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    made = [
        (await rest.post("/v1/renders", json={**body, "request_id": f"r{n}"})).json()["id"] for n in range(5)
    ]
    seen: list[str] = []
    token = ""
    for size in (2, 2, 1):
        page = (await rest.get("/v1/renders", params={"page_size": 2, "page_token": token})).json()
        assert len(page["renders"]) == size
        seen += [render["id"] for render in page["renders"]]
        token = page["next_page_token"]
    assert token == ""
    assert seen == made[::-1]
    first = await Stub(channel).ListRenders(pb.ListRendersRequest(page_size=4))
    rest_of_it = await Stub(channel).ListRenders(
        pb.ListRendersRequest(page_size=4, page_token=first.next_page_token)
    )
    assert [render.id for render in (*first.renders, *rest_of_it.renders)] == seen


async def test_cancel_twice_is_cancel_once(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    first = (await rest.post(f"/v1/renders/{render_id}:cancel", json={"request_id": "c1"})).json()
    assert first["state"] == "CANCELLED"
    assert first["reason"]
    assert (await rest.post(f"/v1/renders/{render_id}:cancel")).json() == first
    again = await Stub(channel).CancelRender(pb.CancelRenderRequest(id=render_id, request_id="c2"))
    assert again.sequence == first["sequence"]


async def test_preview_with_etag_at_both_endpoints(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    path = f"/v1/renders/{render_id}/preview.png"
    before = await rest.get(path)
    assert (before.status_code, before.json()["detail"]) == (404, "no preview yet")

    content = bytes(range(256)) * 3000
    coordinator_acts.picture(folder, render_id, content)
    first = await rest.get(path)
    assert (first.status_code, first.content, first.headers["content-type"]) == (200, content, "image/png")
    etag = first.headers["etag"]
    assert (await rest.get(path, headers={"If-None-Match": etag})).status_code == 304
    chunks = [chunk async for chunk in Stub(channel).FetchImage(_preview_of(render_id))]
    assert b"".join(chunk.data for chunk in chunks) == content
    assert [chunk.etag for chunk in chunks] == [etag] + [""] * (len(chunks) - 1)

    coordinator_acts.picture(folder, render_id, content[::-1])
    changed = await rest.get(path, headers={"If-None-Match": etag})
    assert (changed.status_code, changed.content) == (200, content[::-1])


def _preview_of(render_id: str) -> pb.FetchImageRequest:
    return pb.FetchImageRequest(id=render_id, kind=pb.IMAGE_KIND_PREVIEW)


async def test_an_image_kind_must_be_given(rest: httpx.AsyncClient, channel: grpc.aio.Channel) -> None:
    assert (await rest.get("/healthz")).text == "alive\n"
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        async for _ in Stub(channel).FetchImage(pb.FetchImageRequest(id="none")):
            pass
    assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT


async def test_convergence(body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder) -> None:
    render = (await rest.post("/v1/renders", json=body)).json()
    folder.database.execute(
        "INSERT INTO error_point VALUES (?, ?, ?, ?, ?, 0.25, 70.0)",
        (render["id"], render["created"] + 2.5, 4800, 4.0, 0.125),
    )
    points = (await rest.get(f"/v1/renders/{render['id']}/convergence")).json()["points"]
    assert points == [
        {
            "time_s": pytest.approx(2.5),
            "samples": 4.0,
            "relative_error": 0.125,
            "worst_share": 0.25,
            "effective_sample_size_of_pixels": 70.0,
        }
    ]


async def test_workers(rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder) -> None:
    assert (await rest.get("/v1/workers")).json() == {"workers": []}
    folder.database.execute(
        "INSERT INTO worker VALUES ('w1', 1, 2, 10, 20, 5.5, 3, 1.0, unixepoch() + 0.0, 'a1')",
    )
    (worker,) = (await rest.get("/v1/workers")).json()["workers"]
    assert worker == {
        "id": "w1",
        "engine": 1,
        "threads": 2,
        "rays_per_second": 11.0,
        "jobs_done": 3,
        "started": 1.0,
        "quarantine": "",
        "drain": "",
        "floating_point_profile": "a1",
        "incompatible": f"It has engine 1, and the service engine {int(job_pb2.ENGINE_CURRENT)}.",
    }
    (message,) = (await Stub(channel).ListWorkers(pb.ListWorkersRequest())).workers
    assert (message.id, message.jobs_done, message.floating_point_profile) == ("w1", 3, "a1")
    assert message.incompatible == worker["incompatible"]
