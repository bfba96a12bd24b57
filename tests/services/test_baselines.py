"""Renders of the same scene by another version of the tracing engine."""

import asyncio
from typing import Any

import httpx
from nocturne_api.service import Service
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from nocturne_coordinator.store.data_folder import DataFolder
from typer.testing import CliRunner

from tests.services import coordinator_acts


async def made(rest: httpx.AsyncClient, body: dict[str, Any], name: str, **more: Any) -> str:
    answer = await rest.post("/v1/renders", json={**body, "request_id": name, "name": name, **more})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


async def test_the_newest_of_each_other_engine_is_a_baseline(
    rest: httpx.AsyncClient, service: Service, folder: DataFolder, body: dict[str, Any]
) -> None:
    old, newer, oldest, unfinished = [
        await made(rest, body, name) for name in ("old", "newer", "oldest", "unfinished")
    ]
    other_film = await made(rest, body, "other film", width=body["width"] + 1)
    other_scene = await made(rest, body, "other", scene={**body["scene"], "tracing": {"seed": 5}})
    now = await made(rest, body, "now")
    engines = {old: 7, newer: 7, oldest: 6, unfinished: 8, other_film: 7, other_scene: 7}
    for render, engine in engines.items():
        folder.database.execute("UPDATE render SET engine = ? WHERE id = ?", (engine, render))
        if render != unfinished:
            coordinator_acts.finish(folder, render)
    found = (await rest.get(f"/v1/renders/{now}/baselines")).json()["renders"]
    assert [(each["id"], each["engine"]) for each in found] == [(newer, 7), (oldest, 6)]
    assert (await rest.get("/v1/renders/r-none/baselines")).status_code == 404

    def run() -> Any:
        url = f"http://127.0.0.1:{service.port}"
        return CliRunner().invoke(app, ["baseline", now, "--engine", "3", "--url", url])

    result = await asyncio.to_thread(run)
    assert isinstance(result.exception, NocturneClientError)
    assert "no image of the same scene and film by engine 3" in str(result.exception)
