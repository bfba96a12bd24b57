"""Renders: create, get, list, cancel, images, convergence, workers."""

import asyncio
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services import coordinator_acts


async def test_a_new_render_is_queued(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    created = await rest.post("/v1/renders", json=body)
    assert created.status_code == 201
    render = created.json()
    assert render["state"] == "QUEUED"
    assert (render["width"], render["height"], render["samples"]) == (40, 30, 16)
    assert (await rest.get(f"/v1/renders/{render['id']}")).json() == render


async def test_create_is_idempotent(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    first = (await rest.post("/v1/renders", json=body)).json()
    assert (await rest.post("/v1/renders", json=body)).json()["id"] == first["id"]
    assert len((await rest.get("/v1/renders")).json()["renders"]) == 1


async def test_a_request_id_with_other_content_is_a_conflict(
    body: dict[str, Any], rest: httpx.AsyncClient, tmp_path: Path
) -> None:
    await rest.post("/v1/renders", json=body)
    blobs = sorted((tmp_path / "data" / "blobs").rglob("*"))
    body["scene"]["surfaces"][0]["shape"]["vertices"][0] = [9, 9, 9]
    answer = await rest.post("/v1/renders", json=body)
    assert (answer.status_code, answer.json()["reason"]) == (409, "CONFLICT")
    assert sorted((tmp_path / "data" / "blobs").rglob("*")) == blobs


async def test_pages_are_newest_first_and_complete(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
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


async def test_cancel_twice_is_cancel_once(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    first = (await rest.post(f"/v1/renders/{render_id}:cancel", json={"request_id": "c1"})).json()
    assert first["state"] == "CANCELLED"
    assert first["reason"]
    assert (await rest.post(f"/v1/renders/{render_id}:cancel")).json() == first


async def test_preview_with_etag(body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder) -> None:
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

    coordinator_acts.picture(folder, render_id, content[::-1])
    changed = await rest.get(path, headers={"If-None-Match": etag})
    assert (changed.status_code, changed.content) == (200, content[::-1])


async def test_people_who_change_one_render_at_once_lose_nothing_of_each_other(
    body: dict[str, Any], rest: httpx.AsyncClient
) -> None:
    """Each call says one thing, so there is no If-Match: of two that say the same thing the last one counts,
    and the log has both."""
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    address = f"/v1/renders/{render_id}"
    region = {"x": 0, "y": 0, "width": 8, "height": 8}
    changes = [
        *((f"{address}:setPriority", {"priority": number}) for number in (5, 6, 7)),
        *((f"{address}:setTags", {"tags": [tag]}) for tag in ("a", "b")),
        (f"{address}:lookFirst", region),
        (f"{address}:extend", {"samples": 99}),
        (f"{address}:pause", {}),
    ]
    answers = await asyncio.gather(*(rest.post(path, json=change) for path, change in changes))
    assert [answer.status_code for answer in answers] == [200] * len(changes)
    render = (await rest.get(address)).json()
    assert render["priority"] in (5, 6, 7)
    assert render["tags"] in (["a"], ["b"])
    assert (render["samples"], render["state"]) == (99, "PAUSED")
    last = max((answer.json() for answer in answers), key=lambda each: each["sequence"])
    assert last == render
    log = (await rest.get(f"{address}/log.txt")).text
    said = ("priority", "tags", "look first", "extend", "pause")
    assert [log.count(f"  {what}: done") for what in said] == [3, 2, 1, 1, 1]


async def test_part_of_a_picture(body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder) -> None:
    """A download that broke off goes on where it was, unless the file is another by now (RFC 9110, 14)."""
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    path, content = f"/v1/renders/{render_id}/preview.png", bytes(range(256)) * 3000
    coordinator_acts.picture(folder, render_id, content)
    size, head = len(content), await rest.head(path)
    assert (head.status_code, head.content, int(head.headers["content-length"])) == (200, b"", size)
    assert head.headers["accept-ranges"] == "bytes"
    parts = [("bytes=0-9", 0, 10), ("bytes=500000-", 500_000, size), ("bytes=-7", size - 7, size)]
    for asked, first, end in [*parts, ("bytes=5-9999999", 5, size), ("bytes=-9999999", 0, size)]:
        part = await rest.get(path, headers={"Range": asked, "If-Range": head.headers["etag"]})
        assert (part.status_code, part.content) == (206, content[first:end])
        assert part.headers["content-range"] == f"bytes {first}-{end - 1}/{size}"
    for asked in ("bytes=0-1,5-6", "bytes=9-5", "bytes=-", "lines=1-2", "bytes=" + "9" * 5000 + "-"):
        assert (await rest.get(path, headers={"Range": asked})).content == content
    for asked in (f"bytes={size}-", "bytes=-0"):
        none = await rest.get(path, headers={"Range": asked})
        assert (none.status_code, none.headers["content-range"]) == (416, f"bytes */{size}")
    coordinator_acts.picture(folder, render_id, content[::-1])
    other = await rest.get(path, headers={"Range": "bytes=9-", "If-Range": head.headers["etag"]})
    assert (other.status_code, other.content) == (200, content[::-1])


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
            "top_percent_share": 0.25,
            "effective_pixels": 70.0,
        }
    ]


async def test_workers(rest: httpx.AsyncClient, folder: DataFolder) -> None:
    assert (await rest.get("/v1/workers")).json() == {"workers": []}
    folder.database.execute(
        "INSERT INTO worker VALUES ('w1', 1, 2, 10, 20, 5.5, 3, 1.0, ?, 'a1')", (time.time(),)
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
        "unaudited": "",
        "floating_point_profile": "a1",
        "incompatible": f"It has engine 1, and the service engine {int(job_pb2.ENGINE_CURRENT)}.",
    }
