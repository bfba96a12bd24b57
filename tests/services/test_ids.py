"""Renders may be named by the first characters of their ids, and lists show ids whole."""

import asyncio
import secrets
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_api.service import Service
from nocturne_client.cli.app import app
from nocturne_client.console import CONSOLE
from nocturne_coordinator.store.data_folder import DataFolder
from typer.testing import CliRunner, Result

from tests.services import coordinator_acts

Stub = render_service_pb2_grpc.RenderServiceStub


@pytest.fixture
async def renders(
    body: dict[str, Any], rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> list[str]:
    """Three renders; the ids of the first two begin alike."""
    # In base 32, five bits make a letter: "aaaa...", "aaab...", "7777...".
    bits = iter([bytes(8), b"\x00\x00\x10" + bytes(5), b"\xff" * 8])
    monkeypatch.setattr(secrets, "token_bytes", lambda _: next(bits))
    bodies = ({**body, "request_id": f"r{number}"} for number in range(3))
    made = [(await rest.post("/v1/renders", json=each)).json()["id"] for each in bodies]
    assert made == ["r-aaaaaaaaaaaa", "r-aaabaaaaaaaa", "r-777777777777"]
    return made


async def test_the_beginning_is_enough(renders: list[str], rest: httpx.AsyncClient) -> None:
    assert (await rest.get("/v1/renders/r-7")).json()["id"] == renders[2]
    assert (await rest.get("/v1/renders/r-aaab")).json()["id"] == renders[1]
    paused = (await rest.post("/v1/renders/r-aaab:pause")).json()
    assert (paused["id"], paused["state"]) == (renders[1], "PAUSED")
    assert (await rest.get("/v1/renders/r-aaab/convergence")).json() == {"points": []}
    assert (await rest.get("/v1/renders/r-aaab/tiles-in-progress")).status_code == 200
    assert (await rest.get("/v1/renders/r-aaab/explanation")).json()["sentence"]


async def test_a_beginning_of_several_names_them(renders: list[str], rest: httpx.AsyncClient) -> None:
    answer = await rest.post("/v1/renders/r-aaa:cancel")
    assert (answer.status_code, answer.json()["reason"]) == (409, "AMBIGUOUS_ID")
    assert f"begins with 'r-aaa': {renders[0]}, {renders[1]}" in answer.json()["detail"]
    assert {each["state"] for each in (await rest.get("/v1/renders")).json()["renders"]} == {"QUEUED"}


@pytest.mark.parametrize("wrong", ["", "x", "r-b", "r-7777777777777", "R-7", "%", "_", "r-7%"])
async def test_what_begins_no_id_is_not_found(
    wrong: str, renders: list[str], channel: grpc.aio.Channel
) -> None:
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await Stub(channel).GetRender(pb.GetRenderRequest(id=wrong))
    assert caught.value.code() == grpc.StatusCode.NOT_FOUND, renders


async def test_deleting_takes_the_whole_id(
    renders: list[str], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    coordinator_acts.finish(folder, renders[2])
    answer = await rest.delete("/v1/renders/r-7")
    assert (answer.status_code, answer.json()["reason"]) == (404, "NOT_FOUND")
    assert "deleting takes the whole id" in answer.json()["detail"]
    assert (await rest.delete(f"/v1/renders/{renders[2]}")).status_code == 204


async def _nocturne(service: Service, *words: str) -> Result:
    environment = {"NOCTURNE_URL": f"http://127.0.0.1:{service.port}"}
    return await asyncio.to_thread(CliRunner().invoke, app, [*words], env=environment)


async def test_the_command_line_takes_beginnings(
    renders: list[str], service: Service, folder: DataFolder
) -> None:
    assert renders[2] in (await _nocturne(service, "get", "r-7")).stdout
    coordinator_acts.finish(folder, renders[2])
    assert (await _nocturne(service, "watch", "r-7")).exit_code == 0
    assert (await _nocturne(service, "delete", "r-7")).exit_code == 0
    assert renders[2] not in (await _nocturne(service, "list")).stdout


async def test_a_list_has_a_line_for_each_render_in_80_columns(
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    service: Service,
    folder: DataFolder,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = "a name that is much too long for a terminal, and for two of them as well, one beside the other"
    made = (await rest.post("/v1/renders", json={**body, "name": name})).json()
    folder.database.execute(
        """UPDATE render SET state = 'STOPPED_EARLY', width = 1920, height = 1080, relative_error = 0.4321,
               error_warning = 'so', created = created - 7000"""
    )
    monkeypatch.setattr(CONSOLE, "width", 80)
    shown = (await _nocturne(service, "list")).stdout.splitlines()
    assert len(shown) == 2
    assert all(len(line) <= 80 for line in shown)
    row = shown[1].split()
    assert (row[0], row[-1], row[-2], row[-3]) == (made["id"], "min", "117", "43.21%?")
    assert "STOPPED_EARLY" in row


@pytest.mark.parametrize("columns", [10, 40, 80])
async def test_lists_show_whole_ids_however_narrow(
    columns: int, renders: list[str], service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CONSOLE, "width", columns)
    shown = (await _nocturne(service, "list")).stdout
    assert [line.split()[0] for line in shown.splitlines() if line.startswith("r-")] == renders[::-1]


async def test_the_shell_is_told_what_ids_there_are(renders: list[str], service: Service) -> None:
    asked = {"_NOCTURNE_COMPLETE": "complete_bash", "COMP_WORDS": "nocturne get r-a", "COMP_CWORD": "2"}
    environment = {"NOCTURNE_URL": f"http://127.0.0.1:{service.port}", **asked}
    told = await asyncio.to_thread(
        CliRunner().invoke, app, [], env=environment, prog_name="nocturne", complete_var="_NOCTURNE_COMPLETE"
    )
    assert sorted(told.stdout.split()) == sorted(renders[:2])
