"""What keeps a night going, by REST and the command line: conditions, pauses, extensions."""

import json
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
import typer
from nocturne_api.service import Service
from nocturne_client.cli.app import app
from nocturne_client.cli.stops import Stops, with_zone
from nocturne_coordinator.store.data_folder import DataFolder
from typer.testing import CliRunner

from tests.services import coordinator_acts

STOP: dict[str, Any] = {
    "relative_error": 0.01,
    "tile_relative_error": 0.05,
    "wall_seconds": 60.0,
    "cpu_seconds": 3600.0,
}


async def test_stop_conditions_come_back(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    stop = {**STOP, "until": "07:00 Europe/Berlin"}
    answer = await rest.post("/v1/renders", json={**body, "stop": stop, "priority": 300})
    assert answer.status_code == 201, answer.text
    render = answer.json()
    assert {name: render["stop"][name] for name in stop} == stop
    assert 0 < render["stop"]["until_time"] - time.time() <= 86400 + 3600
    assert render["priority"] == 300
    # The same words are the same request, whenever they are repeated.
    again = await rest.post("/v1/renders", json={**body, "stop": stop, "priority": 300})
    assert again.json()["id"] == render["id"]
    other = await rest.post("/v1/renders", json={**body, "stop": {}, "priority": 300})
    assert other.json()["reason"] == "CONFLICT"


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"stop": {"relative_error": -1}}, "$.stop.relative_error"),
        ({"stop": {"until": "07:00"}}, "$.stop.until"),
        ({"stop": {"patience": 3}}, "$.stop.patience"),
        ({"stop": {"tile_samples": [4]}}, "$.stop.tile_samples"),
        ({"priority": 1001}, "$.priority"),
        ({"priority": -1}, "$.priority"),
    ],
)
async def test_what_can_not_be_asked_for_is_named(
    body: dict[str, Any], rest: httpx.AsyncClient, change: dict[str, Any], place: str
) -> None:
    answer = await rest.post("/v1/renders", json=body | change)
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == [place]


async def test_pause_resume_priority_extend(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    path = f"/v1/renders/{render_id}"
    for _ in range(2):
        assert (await rest.post(f"{path}:pause")).json()["state"] == "PAUSED"
    assert (await rest.post(f"{path}:resume", json={})).json()["state"] == "QUEUED"
    changed = (await rest.post(f"{path}:setPriority", json={"priority": 7})).json()
    assert changed["priority"] == 7
    assert (await rest.post(f"{path}:setPriority", json={"priority": 0})).status_code == 422

    coordinator_acts.progress(folder, render_id, 40 * 30 * 16)
    coordinator_acts.finish(folder, render_id)
    for verb in ("pause", "resume"):
        answer = await rest.post(f"{path}:{verb}")
        assert (answer.status_code, answer.json()["reason"]) == (409, "WRONG_STATE")

    assert (await rest.post(f"{path}:extend", json={"samples": 8})).status_code == 422
    extended = (await rest.post(f"{path}:extend", json={"samples": 64, "stop": STOP})).json()
    assert (extended["state"], extended["samples"], extended["ended"]) == ("QUEUED", 64, 0.0)
    assert extended["progress"]["mean_samples"] == 16
    again = (await rest.post(f"{path}:extend", json={"samples": 64, "stop": STOP})).json()
    assert again["sequence"] == extended["sequence"]


async def test_an_extension_changes_only_what_it_names(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    asked = {**STOP, "until": "07:00 Europe/Berlin"}
    render_id = (await rest.post("/v1/renders", json={**body, "stop": asked})).json()["id"]
    path = f"/v1/renders/{render_id}:extend"
    more = (await rest.post(path, json={"samples": 64})).json()
    assert more["samples"] == 64
    assert {name: more["stop"][name] for name in asked} == asked
    changed = (await rest.post(path, json={"stop": {"relative_error": 0.02}})).json()["stop"]
    assert changed == {**more["stop"], "relative_error": 0.02}
    dropped = (await rest.post(path, json={"drop": ["until", "tile_relative_error"]})).json()["stop"]
    assert dropped == {**changed, "until": "", "until_time": 0.0, "tile_relative_error": 0.0}


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"stop": {"relative_error": 0}}, "$.stop.relative_error"),
        ({"stop": {"until": ""}}, "$.stop.until"),
        ({"drop": ["patience"]}, "$.drop[0]"),
        ({"drop": ["until"], "stop": {"until": "08:00Z"}}, "$.stop.until"),
    ],
)
async def test_an_extension_says_what_it_drops(
    body: dict[str, Any], rest: httpx.AsyncClient, change: dict[str, Any], place: str
) -> None:
    render_id = (await rest.post("/v1/renders", json={**body, "stop": STOP})).json()["id"]
    answer = await rest.post(f"/v1/renders/{render_id}:extend", json=change)
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == [place]


async def test_what_would_end_at_once_is_not_extended(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    asked = {**body, "stop": {"cpu_seconds": 5.0}}
    render_id = (await rest.post("/v1/renders", json=asked)).json()["id"]
    folder.database.execute(
        "UPDATE render SET state = 'STOPPED_EARLY', cpu_seconds = 6 WHERE id = ?", (render_id,)
    )
    path = f"/v1/renders/{render_id}:extend"
    refused = await rest.post(path, json={"samples": 64})
    assert refused.status_code == 422
    assert "cpu_seconds" in refused.json()["detail"]
    assert (await rest.post(path, json={"samples": 64, "drop": ["cpu_seconds"]})).json()["state"] == "QUEUED"


async def test_replay_needs_samples(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    answer = await rest.post(f"/v1/renders/{render_id}:replay", json={"request_id": "again"})
    assert answer.json()["reason"] == "WRONG_STATE"
    folder.database.execute(
        "INSERT INTO tile (render_id, tile_index, samples, sums) VALUES (?, 1, 8, x'00')", (render_id,)
    )
    replay = (await rest.post(f"/v1/renders/{render_id}:replay", json={"request_id": "again"})).json()
    assert folder.database.row("SELECT stop FROM render WHERE id = ?", (replay["id"],))["stop"] == (  # type: ignore[index]
        '{"tile_samples":[0,8]}'
    )
    again = (await rest.post(f"/v1/renders/{render_id}:replay", json={"request_id": "again"})).json()
    assert again["id"] == replay["id"]


async def test_the_command_line_does_it_all(
    body: dict[str, Any], service: Service, rest: httpx.AsyncClient, tmp_path: Path, folder: DataFolder
) -> None:
    import asyncio

    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(body["scene"]))

    async def nocturne(*words: str, expect: int = 0) -> str:
        environment = {"NOCTURNE_URL": f"http://127.0.0.1:{service.port}", "TERM": "dumb", "COLUMNS": "200"}
        result = await asyncio.to_thread(CliRunner().invoke, app, words, env=environment)
        assert result.exit_code == expect, (words, result.output, result.exception)
        return result.output.strip()

    conditions = (
        "--error",
        "1%",
        "--tile-error",
        "0.05",
        "--for",
        "8h",
        "--cpu",
        "40 h",
        "--until",
        "07:00Z",
    )
    render_id = await nocturne("submit", str(scene), "--width", "40", "--height", "30", *conditions)
    stop = (await rest.get(f"/v1/renders/{render_id}")).json()["stop"]
    assert (stop["relative_error"], stop["tile_relative_error"]) == (0.01, 0.05)
    assert (stop["wall_seconds"], stop["cpu_seconds"], stop["until"]) == (28800.0, 144000.0, "07:00Z")
    assert "relative error 1.000%" in await nocturne("get", render_id)
    assert json.loads(await nocturne("pause", render_id, "--json"))["state"] == "PAUSED"
    assert "paused" in await nocturne("explain", render_id)
    assert json.loads(await nocturne("resume", render_id, "--json"))["state"] == "QUEUED"
    assert json.loads(await nocturne("priority", render_id, "250", "--json"))["priority"] == 250
    assert json.loads(await nocturne("extend", render_id, "--samples", "512", "--json"))["samples"] == 512
    assert "No coordinator" in await nocturne("explain", render_id)
    assert "no worker" in await nocturne("workers")
    folder.database.execute(
        "INSERT INTO worker VALUES ('w1', 2, 2, 10, 20, 5.5, 3, 1.0, ?, 'a1')", (time.time(),)
    )
    folder.database.execute("INSERT INTO quarantine VALUES ('w1', 'Wrong results.', 1.0)")
    assert "Wrong results." in await nocturne("workers")
    assert "Wrong results." not in await nocturne("workers", "--release", "w1")
    assert "Draining: it finishes" in await nocturne("workers", "--drain", "w1")
    folder.database.execute("UPDATE drain SET since = 1.0")
    assert "Drained: it has none." in await nocturne("workers")
    assert "Drained" not in await nocturne("workers", "--release", "w1")
    await nocturne("submit", str(scene), "--error", "a lot", expect=2)
    data = ("--data", str(tmp_path / "data"))
    secret = await nocturne("token", "create", "ann", "--scope", "submit", *data)
    assert secret.startswith("nct_")
    assert "ann  submit  weight 100" in await nocturne("token", "list", *data)
    await nocturne("token", "revoke", "ann", *data)
    assert "ann  revoked" in await nocturne("token", "list", *data)
    assert secret not in (tmp_path / "data" / "nocturne.db").read_bytes().decode(errors="replace")


def test_a_clock_on_the_wall_gets_its_zone(monkeypatch: pytest.MonkeyPatch) -> None:
    from datetime import datetime

    monkeypatch.setenv("TZ", "Europe/Berlin")
    time.tzset()
    try:
        # The clocks go forward in this night: tomorrow's zone is another than today's.
        evening = datetime(2026, 3, 28, 18, 0)  # noqa: DTZ001 - the clock on the wall
        assert with_zone("07:00", evening) == "2026-03-29T07:00:00+02:00"
        assert with_zone("19:00", evening) == "2026-03-28T19:00:00+01:00"
        assert with_zone("07:00 Asia/Tokyo", evening) == "07:00 Asia/Tokyo"
    finally:
        monkeypatch.undo()
        time.tzset()
    for typed in ("2", "100%"):
        with pytest.raises(typer.BadParameter, match="less than 100 %"):
            Stops(error=typed).asked()
    assert Stops(error="2.5%", duration="1.5 h").asked() == {"relative_error": 0.025, "wall_seconds": 5400.0}
