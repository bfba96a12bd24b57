"""Preflights at both endpoints: small renders in a child process, which nothing else waits for."""

import asyncio
import json
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_api.children import pools
from nocturne_api.children.pools import answer_of
from nocturne_api.service import Service
from nocturne_client import Client
from nocturne_client.contract import PreflightReport


@pytest.fixture
def preflight_body(scene: dict[str, Any]) -> dict[str, Any]:
    """The lamp behind glass that disperses, seen by a camera."""
    scene["surfaces"][0] = {
        "shape": {"type": "sphere", "centre": [0.5, 0.5, 1], "radius": 0.3},
        "kernel": {"type": "dielectric", "index": "N-BK7"},
    }
    return {"scene": scene, "width": 24, "height": 16, "error": 0.1, "budget_seconds": 1.0}


async def test_both_endpoints_and_the_client_tell_what_a_scene_needs(
    service: Service,
    channel: grpc.aio.Channel,
    preflight_body: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The client asks by REST. What both endpoints ask of the child is the same, so it answers once."""
    asked: list[Any] = []
    answers: list[Any] = []

    async def answer_once(program: Any, job: Any, seconds: float) -> Any:
        asked.append(job)
        if not answers:
            answers.append(await answer_of(program, job, seconds))
        return answers[0]

    monkeypatch.setattr(pools, "answer_of", answer_once)
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(preflight_body["scene"]))

    def preflight() -> PreflightReport:
        with Client(f"http://127.0.0.1:{service.port}") as client:
            return client.preflight(scene, 24, 16, 0.1, 1.0)

    report = await asyncio.to_thread(preflight)
    parts = [each.without[0] for each in report.models]
    assert "one index of refraction, at 589.29 nm" in parts
    assert "at most 2 interactions" in parts
    assert (report.error, report.film, report.pilot.film) == (0.1, [24, 16], [24, 16])
    assert report.document["nocturne"] == 1
    stub = render_service_pb2_grpc.RenderServiceStub(channel)
    wanted = {**preflight_body, "scene_json": json.dumps(preflight_body["scene"]).encode()}
    del wanted["scene"]
    other = await stub.Preflight(render_service_pb2.PreflightRequest(**wanted), timeout=300)
    again = json.loads(other.report_json)
    assert [each["without"][0] for each in again["models"]] == parts
    assert asked[0] == asked[1]


async def test_problems_are_told_before_anything_is_rendered(
    rest: httpx.AsyncClient, preflight_body: dict[str, Any]
) -> None:
    preflight_body |= {"error": 1.5, "budget_seconds": 1e9, "width": 0}
    preflight_body["scene"]["surfaces"][0]["colour"] = "red"
    answer = await rest.post("/v1/preflights", json=preflight_body)
    assert answer.status_code == 422
    places = {each["place"] for each in answer.json()["problems"]}
    assert {"$.error", "$.budget_seconds", "$.surfaces[0].colour"} < places


async def test_files_that_nobody_uploaded_are_named(
    rest: httpx.AsyncClient, preflight_body: dict[str, Any]
) -> None:
    digest = "sha256:" + "0" * 64
    preflight_body["scene"]["surfaces"][0]["shape"] = {"type": "mesh", "asset": digest, "format": "ply"}
    answer = await rest.post("/v1/preflights", json=preflight_body, timeout=300)
    assert answer.status_code == 422
    assert digest in answer.text


async def test_one_preflight_at_a_time_and_none_for_ever(
    rest: httpx.AsyncClient, preflight_body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A preflight that takes too long is ended, and its processes with it; meanwhile a second one is
    refused."""
    monkeypatch.setattr(pools, "PREFLIGHT_WALL_S", 2.5)
    preflight_body |= {"budget_seconds": 120.0, "error": 1e-4}
    first = asyncio.create_task(rest.post("/v1/preflights", json=preflight_body, timeout=300))
    await asyncio.sleep(0.5)
    second = await rest.post("/v1/preflights", json=preflight_body, timeout=300)
    assert second.status_code == 503
    assert "another preflight" in second.json()["detail"]
    assert (await first).status_code == 503
    assert _preflights_running() == []


def _preflights_running() -> list[str]:
    """Command lines of pool children of this process."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        except (OSError, ValueError):
            continue
        if "nocturne_api.children.preflight" in words and parent == _own_pid():
            found.append(" ".join(words))
    return found


def _own_pid() -> int:
    return int(Path("/proc/self").readlink().name)


async def test_without_the_tracer_it_says_so(
    rest: httpx.AsyncClient, service: Service, preflight_body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert service.port
    monkeypatch.setattr(pools, "_PREFLIGHT", ("-c", 'print(\'{"failed": "nocturne-trace is missing"}\')'))
    answer = await rest.post("/v1/preflights", json=preflight_body, timeout=300)
    assert answer.status_code == 409
    assert "nocturne-trace is missing" in answer.json()["detail"]
