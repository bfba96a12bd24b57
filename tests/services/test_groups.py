"""Groups: many renders of one submission, as one; and what waits for their end."""

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.service import Service
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from nocturne_client.sequences import members_of
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from typer.testing import CliRunner

from tests.services import coordinator_acts


async def submit(rest: httpx.AsyncClient, body: dict[str, Any], name: str, **more: str) -> str:
    answer = await rest.post("/v1/renders", json={**body, "request_id": name, **more})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


async def test_a_group_is_told_as_one(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    frames = [await submit(rest, body, f"frame {i}", group="film") for i in range(4)]
    await submit(rest, body, "alone")
    coordinator_acts.finish(folder, frames[0])
    await rest.post(f"/v1/renders/{frames[1]}:cancel")
    told = (await rest.get("/v1/groups/film")).json()
    assert (told["renders"], told["ended"], told["failed"]) == (4, 2, 1)
    assert told["fraction"] == 0.5
    listed = (await rest.get("/v1/renders", params={"group": "film", "page_size": 3})).json()
    assert [each["id"] for each in listed["renders"]] == frames[:0:-1]
    rest_of_it = {"group": "film", "page_size": 3, "page_token": listed["next_page_token"]}
    listed = (await rest.get("/v1/renders", params=rest_of_it)).json()
    assert [each["id"] for each in listed["renders"]] == frames[:1]
    assert {each["group"] for each in listed["renders"]} == {"film"}


@pytest.mark.parametrize("name", ["film", "%20"])
async def test_a_group_without_renders_is_none(rest: httpx.AsyncClient, name: str) -> None:
    assert (await rest.get(f"/v1/groups/{name}")).status_code == 404


async def test_what_comes_after_a_group_waits_for_its_end(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    first = await submit(rest, body, "first", group="draft")
    second = await submit(rest, body, "second", group="final", after="draft")
    third = await submit(rest, body, "third", after="nobody knows it")
    ledger = Ledger(folder.database, Ownership(folder.root, folder.database))
    assert {each.id for each in ledger.renders.all()} == {first, third}
    explained = (await rest.get(f"/v1/renders/{second}/explanation")).json()["sentence"]
    assert explained == "It waits until the group draft has ended."
    coordinator_acts.finish(folder, first)
    explained = (await rest.get(f"/v1/renders/{second}/explanation")).json()["sentence"]
    assert "group" not in explained
    assert {each.id for each in ledger.renders.all()} == {second, third}


async def test_a_group_can_not_wait_for_itself(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    answer = await rest.post("/v1/renders", json={**body, "group": "film", "after": "film"})
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == ["$.after"]


def test_frames_go_evenly_from_the_first_to_the_last(tmp_path: Path) -> None:
    changes = {"sensor.position[0]": "0..2", "tracing.seed": 7}
    members = members_of(tmp_path / "room.json", changes, "8-12", [])
    assert [member.name for member in members] == ["08", "09", "10", "11", "12"]
    assert [member.changes["sensor.position[0]"] for member in members] == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert {member.changes["tracing.seed"] for member in members} == {7}


@pytest.mark.parametrize("frames", ["5-5", "0-0"])
def test_one_frame_has_the_first_value(tmp_path: Path, frames: str) -> None:
    """https://github.com/AcademySoftwareFoundation/OpenCue/issues/1129: one frame is a render, too."""
    [member] = members_of(tmp_path / "room.json", {"sensor.position[0]": "0..1"}, frames, [])
    assert member.changes == {"sensor.position[0]": 0.0}
    assert member.name == frames[0]


def test_names_of_variants_are_short(tmp_path: Path) -> None:
    """Of a part of a scene its name or type, with a number where several have the same."""
    sensors = '{"type":"panorama","position":[0,0,0]},{"type":"pinhole"},{"type":"pinhole","name":"door"}'
    more = '{"type":"pinhole","look_at":[1,0,0]}'
    members = members_of(tmp_path / "room.json", {}, "", [f"sensor={sensors},{more}"])
    assert [member.name for member in members] == [
        "sensor=panorama",
        "sensor=pinhole 2",
        "sensor=door",
        "sensor=pinhole 4",
    ]
    look_at = members_of(tmp_path / "room.json", {}, "", ["sensor.look_at=[0, 0, 0],[1.5, 0, 0]"])
    assert [member.name for member in look_at] == ["look_at=[0,0,0]", "look_at=[1.5,0,0]"]
    flags = members_of(tmp_path / "room.json", {}, "", [f"a.two_sided=true,{'x' * 100}"])
    assert [member.name for member in flags] == ["two_sided=true", f"two_sided={'x' * 39}\u2026"]
    numbered = members_of(tmp_path / "room.json", {}, "", [f"a.b=[{'1,' * 50}1],[{'1,' * 50}2]"])
    assert len({member.name for member in numbered}) == 2


def test_variants_are_all_that_can_be(tmp_path: Path) -> None:
    varied = ["tracing.seed=1,2", "surfaces[0].kernel.reflectance=0.2,white"]
    members = members_of(tmp_path / "room.json", {}, "", varied)
    assert [member.name for member in members] == [
        "seed=1 reflectance=0.2",
        "seed=1 reflectance=white",
        "seed=2 reflectance=0.2",
        "seed=2 reflectance=white",
    ]
    assert members[1].changes == {"tracing.seed": 1, "surfaces[0].kernel.reflectance": "white"}


def test_values_may_be_any_json(tmp_path: Path) -> None:
    members = members_of(tmp_path / "room.json", {}, "", ["sensor.look_at=[0, 0, 0], [1, 0, 0]"])
    assert [member.changes["sensor.look_at"] for member in members] == [[0, 0, 0], [1, 0, 0]]


async def test_the_command_submits_a_group_and_tells_of_it(
    rest: httpx.AsyncClient, service: Service, scene: dict[str, Any], tmp_path: Path
) -> None:
    (tmp_path / "room.json").write_text(json.dumps({**scene, "name": "Room"}))
    film = ["--width", "8", "--height", "8", "--samples", "4"]
    more = ["--frames", "1-3", "--set", "sensor.position[0]=0..1", "--group", "film", "--request-id", "a"]
    command = ["submit", str(tmp_path / "room.json"), *film, *more]
    said = [await run(service, *command) for _ in range(2)]
    assert said[0] == said[1]
    assert said[0].splitlines()[0] == "group film"
    frames = (await rest.get("/v1/renders", params={"group": "film"})).json()["renders"]
    assert [each["name"] for each in frames] == ["Room 3", "Room 2", "Room 1"]
    assert said[0].splitlines()[:0:-1] == [each["id"] for each in frames]
    middle = (await rest.get(f"/v1/renders/{frames[1]['id']}/scene.json")).json()
    assert middle["sensor"]["position"] == [0.5, 0, 4]
    assert (await run(service, "group", "film")).startswith("film: 0 of 3 renders have ended, 0.0% is done")


async def test_documents_of_a_folder_are_told_by_their_files(
    rest: httpx.AsyncClient, service: Service, scene: dict[str, Any], tmp_path: Path
) -> None:
    nameless = {key: value for key, value in scene.items() if key != "name"}
    for name, document in (("a", nameless), ("b", {**scene, "name": "Hall"})):
        (tmp_path / f"{name}.json").write_text(json.dumps(document))
    await run(service, "submit", str(tmp_path), "--width", "8", "--height", "8", "--group", "film")
    frames = (await rest.get("/v1/renders", params={"group": "film"})).json()["renders"]
    assert [each["name"] for each in frames] == ["Hall b", "a"]


async def run(service: Service, *words: str) -> str:
    environment = {"NOCTURNE_URL": f"http://127.0.0.1:{service.port}"}
    result = await asyncio.to_thread(CliRunner().invoke, app, list(words), env=environment)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_a_folder_has_its_documents(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / f"{name}.json").write_text(json.dumps({}))
    assert [member.name for member in members_of(tmp_path, {}, "", [])] == ["a", "b"]


def test_one_scene_alone_is_no_group(tmp_path: Path) -> None:
    [member] = members_of(tmp_path / "room.json", {"tracing.seed": "1..2"}, "", [])
    assert (member.name, member.changes) == ("", {"tracing.seed": "1..2"})


@pytest.mark.parametrize("frames", ["12-8", "1", "1-100000", "a-b"])
def test_frames_that_are_none_are_told(frames: str, tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError):
        members_of(tmp_path / "room.json", {}, frames, [])


def test_an_empty_folder_is_told(tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError, match="no scene documents"):
        members_of(tmp_path, {}, "", [])
