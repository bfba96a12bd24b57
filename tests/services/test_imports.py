"""Scenes of other renderers, imported by the service in child processes and submitted from there."""

import asyncio
import hashlib
import io
import json
import zipfile
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.children import pools
from nocturne_api.service import Service
from nocturne_client import Client
from nocturne_client.cli.app import app
from typer.testing import CliRunner

from tests.scene.formats.mitsuba_import import SENSOR
from tests.scene.formats.test_gltf import tree
from tests.services.webhook_receiver import until_true

BALL = '<shape type="sphere"><emitter type="area"/></shape>'
ROOM = f'<scene version="3.0.0">{SENSOR}{BALL}<include filename="parts/floor.xml"/></scene>'
FLOOR = '<scene version="3.0.0"><shape type="cylinder"/></scene>'
CLOTH = '<scene version="3.0.0"><shape type="rectangle"><bsdf type="nonsense"/></shape></scene>'


async def uploaded(rest: httpx.AsyncClient, files: dict[str, bytes]) -> dict[str, str]:
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    for name, content in files.items():
        answer = await rest.put(f"/v1/assets/{digests[name]}", content=content)
        assert answer.status_code in (200, 201), answer.text
    return digests


async def test_a_scene_is_imported_and_rendered(rest: httpx.AsyncClient) -> None:
    files = await uploaded(rest, {"room.xml": ROOM.encode(), "parts/floor.xml": FLOOR.encode()})
    answer = await rest.post("/v1/imports", json={"files": files}, timeout=120)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert (found["scene"], found["width"], found["height"], found["samples"]) == ("room.xml", 40, 20, 7)
    assert found["missing"] == []
    meshes = [each["shape"]["asset"] for each in found["document"]["surfaces"] if "asset" in each["shape"]]
    assert meshes
    for asset in meshes:
        assert (await rest.head(f"/v1/assets/{asset.removeprefix('sha256:')}")).status_code == 200
    body = {"request_id": "1", "scene": found["document"], "width": 8, "height": 8, "samples": 4}
    assert (await rest.post("/v1/renders", json={**body, "name": "room"})).status_code == 201


async def test_an_archive_is_a_scene(rest: httpx.AsyncClient) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("a/model.gltf", json.dumps(tree()))
    files = await uploaded(rest, {"model.zip": packed.getvalue()})
    answer = await rest.post("/v1/imports", json={"files": files, "light": "studio"}, timeout=120)
    assert answer.status_code == 200, answer.text
    assert answer.json()["document"]["environment"]["asset"].startswith("sha256:")


async def test_what_has_no_equal_is_told_or_left_out(rest: httpx.AsyncClient) -> None:
    files = await uploaded(rest, {"room.xml": ROOM.encode(), "parts/floor.xml": CLOTH.encode()})
    refused = await rest.post("/v1/imports", json={"files": files}, timeout=120)
    assert refused.status_code == 422
    [problem] = refused.json()["problems"]
    assert problem["place"].startswith("parts/floor.xml:1")
    assert "nonsense" in problem["message"]
    taken = await rest.post("/v1/imports", json={"files": files, "allow_missing": True}, timeout=120)
    assert taken.status_code == 200
    [missing] = taken.json()["missing"]
    assert missing["place"] == problem["place"]


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"files": {}}, "$.files"),
        ({"files": {"a.xml": "7"}}, "$.files['a.xml']"),
        ({"files": {"a.xml": "0" * 64}}, "$.files"),
        ({"files": {"../a.xml": "ROOM"}}, "$.files"),
        ({"files": {"a.txt": "ROOM"}}, "$.files"),
        ({"files": {"a.xml": "ROOM", "a.xml/b": "ROOM"}}, "$.files"),
        ({"scene": "b.xml"}, "$.scene"),
        ({"light": "/etc/passwd"}, "$.light"),
    ],
)
async def test_wrong_requests_say_where(rest: httpx.AsyncClient, change: dict[str, Any], place: str) -> None:
    digest = (await uploaded(rest, {"a.xml": ROOM.encode()}))["a.xml"]
    body = json.loads(json.dumps({"files": {"a.xml": digest}, **change}).replace("ROOM", digest))
    answer = await rest.post("/v1/imports", json=body, timeout=120)
    assert answer.status_code == 422, answer.text
    assert answer.json()["problems"][0]["place"] == place


async def test_an_import_that_takes_too_much_is_ended(
    rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """One that hangs, and one that is ended by a bound; the service goes on."""
    files = await uploaded(rest, {"room.xml": ROOM.encode()})
    hanging = tmp_path / "hanging.py"
    hanging.write_text("import time\ntime.sleep(1000)\n")
    monkeypatch.setattr(pools, "_IMPORT", (str(hanging),))
    monkeypatch.setattr(pools, "IMPORT_WALL_S", 0.2)
    answer = await rest.post("/v1/imports", json={"files": files}, timeout=300)
    assert answer.status_code == 422
    assert "within 0.2 s" in answer.text
    monkeypatch.undo()
    dying = tmp_path / "dying.py"
    dying.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGXCPU)\n")
    monkeypatch.setattr(pools, "_IMPORT", (str(dying),))
    answer = await rest.post("/v1/imports", json={"files": files}, timeout=300)
    assert answer.status_code == 422
    assert "processor time" in answer.text


async def test_an_import_outlives_its_request(
    rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A repeated request joins the running import, and later gets the stored answer: one child process for
    all."""
    files = await uploaded(rest, {"room.xml": ROOM.encode(), "parts/floor.xml": FLOOR.encode()})
    starts, go_on = tmp_path / "starts", tmp_path / "go on"
    program = tmp_path / "slow.py"
    program.write_text(
        "import pathlib, runpy, time\n"
        f"with open({str(starts)!r}, 'a') as file: file.write('x')\n"
        f"while not pathlib.Path({str(go_on)!r}).exists(): time.sleep(0.01)\n"
        "runpy.run_module('nocturne_api.children.importing', run_name='__main__')\n"
    )
    monkeypatch.setattr(pools, "_IMPORT", (str(program),))

    async def ask() -> httpx.Response:
        return await rest.post("/v1/imports", json={"files": files}, timeout=120)

    left = asyncio.create_task(ask())
    await until_true(starts.exists, 60)
    left.cancel()
    with pytest.raises(asyncio.CancelledError):
        await left
    again = asyncio.create_task(ask())
    await asyncio.sleep(0.1)
    go_on.touch()
    answer = await again
    assert answer.status_code == 200, answer.text
    assert (await ask()).json() == answer.json()
    assert starts.read_text() == "x"
    other = await rest.post("/v1/imports", json={"files": files, "light": "studio"}, timeout=120)
    assert other.status_code == 200
    assert starts.read_text() == "xx"


async def test_the_client_and_the_command_line_import(service: Service, tmp_path: Path) -> None:
    (tmp_path / "in" / "parts").mkdir(parents=True)
    scene = tmp_path / "in" / "room.xml"
    scene.write_text(ROOM)
    (tmp_path / "in" / "parts" / "floor.xml").write_text(CLOTH)
    url = f"http://127.0.0.1:{service.port}"

    def calls() -> None:
        with Client(url) as client:
            imported = client.import_scene(scene, allow_missing=True)
            assert imported.missing[0].place.startswith("parts/floor.xml:1")
            render = client.submit(imported.document, imported.width, imported.height, 4)
            assert (render.name, render.width, render.height) == ("room", 40, 20)
        asked = ["submit", str(scene), "--samples", "4", "--url", url, "--json"]
        refused = CliRunner().invoke(app, asked)
        assert refused.exit_code != 0
        done = CliRunner().invoke(app, [*asked, "--allow-missing", "--height", "10"])
        assert done.exit_code == 0, done.output
        assert "missing: " in done.stderr
        answered = json.loads(done.stdout)
        assert (answered["name"], answered["width"], answered["height"]) == ("room", 40, 10)

    await asyncio.to_thread(calls)
