"""Plans at both doors: small renders in a child process, which nothing else waits for."""

import asyncio
import json
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_api.preflight import pool as planning
from nocturne_api.service import Service
from nocturne_client import Client


@pytest.fixture
def plan_body(scene: dict[str, Any]) -> dict[str, Any]:
    """The lamp behind glass that disperses, seen by a camera."""
    scene["surfaces"][0] = {
        "shape": {"type": "sphere", "centre": [0.5, 0.5, 1], "radius": 0.3},
        "kernel": {"type": "dielectric", "index": "N-BK7"},
    }
    return {"scene": scene, "width": 24, "height": 16, "error": 0.1, "budget_seconds": 2.0}


async def test_both_doors_tell_what_a_scene_needs(
    rest: httpx.AsyncClient, channel: grpc.aio.Channel, plan_body: dict[str, Any]
) -> None:
    answer = await rest.post("/v1/plans", json=plan_body, timeout=300)
    assert answer.status_code == 200, answer.text
    report = answer.json()
    parts = [each["without"][0] for each in report["models"]]
    assert "one index of refraction, at 589.29 nm" in parts
    assert "at most 2 interactions" in parts
    assert report["pilot"]["film"] == [24, 16]
    assert report["document"]["nocturne"] == 1
    stub = render_service_pb2_grpc.RenderServiceStub(channel)
    asked = {**plan_body, "scene_json": json.dumps(plan_body["scene"]).encode()}
    del asked["scene"]
    other = await stub.PlanScene(render_service_pb2.PlanSceneRequest(**asked), timeout=300)
    again = json.loads(other.report_json)
    # Seeds are the same, and times are not.
    assert [each["without"][0] for each in again["models"]] == parts


async def test_problems_are_told_before_anything_is_rendered(
    rest: httpx.AsyncClient, plan_body: dict[str, Any]
) -> None:
    plan_body |= {"error": 1.5, "budget_seconds": 1e9, "width": 0}
    plan_body["scene"]["surfaces"][0]["colour"] = "red"
    answer = await rest.post("/v1/plans", json=plan_body)
    assert answer.status_code == 422
    places = {each["place"] for each in answer.json()["problems"]}
    assert {"$.error", "$.budget_seconds", "$.surfaces[0].colour"} < places


async def test_files_that_nobody_uploaded_are_named(
    rest: httpx.AsyncClient, plan_body: dict[str, Any]
) -> None:
    digest = "sha256:" + "0" * 64
    plan_body["scene"]["surfaces"][0]["shape"] = {"type": "mesh", "asset": digest, "format": "ply"}
    answer = await rest.post("/v1/plans", json=plan_body, timeout=60)
    assert answer.status_code == 422
    assert digest in answer.text


async def test_one_plan_at_a_time_and_none_for_ever(
    rest: httpx.AsyncClient, plan_body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A plan that takes too long is ended, and its processes with it; meanwhile a second one is refused."""
    monkeypatch.setattr(planning, "PLAN_WALL_S", 4.0)
    plan_body |= {"budget_seconds": 120.0, "error": 1e-4}
    first = asyncio.create_task(rest.post("/v1/plans", json=plan_body, timeout=60))
    await asyncio.sleep(1.5)
    second = await rest.post("/v1/plans", json=plan_body, timeout=60)
    assert second.status_code == 503
    assert "another plan" in second.json()["detail"]
    assert (await first).status_code == 503
    assert _plans_running() == []


def _plans_running() -> list[str]:
    """Command lines of planning children of this process."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, ValueError):
            continue
        if "nocturne_api.preflight.child" in words and parent == _own_pid():
            found.append(" ".join(words))
    return found


def _own_pid() -> int:
    return int(Path("/proc/self").readlink().name)


async def test_without_the_tracer_it_says_so(
    rest: httpx.AsyncClient, service: Service, plan_body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert service.port
    monkeypatch.setattr(planning, "_PROGRAM", ("-c", 'print(\'{"failed": "nocturne-trace is missing"}\')'))
    answer = await rest.post("/v1/plans", json=plan_body, timeout=60)
    assert answer.status_code == 409
    assert "nocturne-trace is missing" in answer.json()["detail"]


async def test_the_client_plans(service: Service, plan_body: dict[str, Any], tmp_path: Path) -> None:
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(plan_body["scene"]))

    def plan() -> dict[str, Any]:
        with Client(f"http://127.0.0.1:{service.port}") as client:
            return client.plan(scene, 24, 16, 0.1, 1.0)

    report = await asyncio.to_thread(plan)
    assert report["error"] == 0.1
    assert report["film"] == [24, 16]
