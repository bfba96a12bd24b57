"""A render's log, and the bundle for those who are asked about it."""

import io
import json
import zipfile
from typing import Any

import httpx
from nocturne_coordinator.store.data_folder import DataFolder


async def test_what_happened_is_told_and_can_be_taken_away(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    render = (await rest.post("/v1/renders", json=body)).json()["id"]
    await rest.post(f"/v1/renders/{render}:pause")
    folder.database.execute(
        "INSERT INTO failed_tile VALUES (?, 3, 0, 4, 'Out of memory.', ?)",
        (render, json.dumps(["w-1", "w-2"])),
    )
    folder.database.execute("INSERT INTO error_point VALUES (?, 1e10, 100, 4, 0.125, 0, 0)", (render,))
    failure = folder.bundle_path(render, 3)
    failure.parent.mkdir(parents=True, exist_ok=True)
    failure.write_bytes(b"as the coordinator wrote it")
    log = (await rest.get(f"/v1/renders/{render}/log.txt")).text.splitlines()
    assert [line.partition("  ")[2] for line in log[:4]] == [
        f"created: {body['width']} x {body['height']}, {body['samples']} samples",
        "create: done",
        "pause: done",
        "4 samples a pixel, relative error 12.500%",
    ]
    assert log[4] == "tile 3 failed on w-1, w-2: Out of memory."
    answer = await rest.get(f"/v1/renders/{render}/bundle.zip")
    assert answer.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(answer.content)) as bundle:
        assert json.loads(bundle.read("render.json"))["state"] == "PAUSED"
        assert json.loads(bundle.read("scene.json"))["nocturne"] == 1
        assert bundle.read("log.txt").decode().splitlines() == log
        assert bundle.read("failed-tile-3.zip") == b"as the coordinator wrote it"
    for name in ("log.txt", "bundle.zip"):
        assert (await rest.get(f"/v1/renders/r-none/{name}")).status_code == 404
