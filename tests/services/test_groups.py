"""Groups: many renders of one submission, as one; and what waits for their end."""

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.models.render_requests import CreateGroupRequest
from nocturne_api.operations.group_members import Member, Members
from nocturne_api.service import Service
from nocturne_client.cli.app import app
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_scene.errors import InputError
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


def members_of(**asked: Any) -> list[Member]:
    common = {"request_id": "a", "scene": {"name": "Room"}, "width": 8, "height": 8, "samples": 4}
    return [*Members(CreateGroupRequest.model_validate({**common, **asked}))]


def test_frames_go_evenly_from_the_first_to_the_last() -> None:
    changes = {"sensor.position[0]": "0..2", "tracing.seed": 7}
    members = members_of(changes=changes, frames={"first": 8, "last": 12})
    assert [member.name for member in members] == ["08", "09", "10", "11", "12"]
    assert [member.changes["sensor.position[0]"] for member in members] == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert {member.changes["tracing.seed"] for member in members} == {7}


@pytest.mark.parametrize("frame", [5, 0])
def test_one_frame_has_the_first_value(frame: int) -> None:
    """https://github.com/AcademySoftwareFoundation/OpenCue/issues/1129: one frame is a render, too."""
    [member] = members_of(changes={"sensor.position[0]": "0..1"}, frames={"first": frame, "last": frame})
    assert member.changes == {"sensor.position[0]": 0.0}
    assert (member.name, member.request_id) == (str(frame), "a")


def variations(**varied: list[Any]) -> list[dict[str, Any]]:
    return [{"place": place.replace("__", "."), "values": values} for place, values in varied.items()]


def test_names_of_variants_are_short() -> None:
    """Of a part of a scene its name or type, with a number where several have the same."""
    sensors = [{"type": "panorama"}, {"type": "pinhole"}, {"type": "pinhole", "name": "door"}]
    members = members_of(varied=variations(sensor=[*sensors, {"type": "pinhole", "look_at": [1, 0, 0]}]))
    assert [member.name for member in members] == [
        "sensor=panorama",
        "sensor=pinhole 2",
        "sensor=door",
        "sensor=pinhole 4",
    ]
    look_at = members_of(varied=variations(sensor__look_at=[[0, 0, 0], [1.5, 0, 0]]))
    assert [member.name for member in look_at] == ["look_at=[0,0,0]", "look_at=[1.5,0,0]"]
    flags = members_of(varied=variations(a__two_sided=[True, "x" * 100]))
    assert [member.name for member in flags] == ["two_sided=true", f"two_sided={'x' * 39}\u2026"]
    numbered = members_of(varied=variations(a__b=[[1] * 50, [1] * 51]))
    assert len({member.name for member in numbered}) == 2


def test_variants_are_all_that_can_be() -> None:
    varied = [
        {"place": "tracing.seed", "values": [1, 2]},
        {"place": "surfaces[0].kernel.reflectance", "values": [0.2, "white"]},
    ]
    members = members_of(varied=varied)
    assert [(member.name, member.request_id) for member in members] == [
        ("seed=1 reflectance=0.2", "a/0"),
        ("seed=1 reflectance=white", "a/1"),
        ("seed=2 reflectance=0.2", "a/2"),
        ("seed=2 reflectance=white", "a/3"),
    ]
    assert members[1].changes == {"tracing.seed": 1, "surfaces[0].kernel.reflectance": "white"}


def test_one_scene_alone_is_no_group() -> None:
    [member] = members_of(changes={"tracing.seed": "1..2"})
    assert (member.name, member.request_id, member.changes) == ("", "a", {"tracing.seed": "1..2"})


@pytest.mark.parametrize(
    ("more", "place", "message"),
    [
        ({"frames": {"first": 12, "last": 8}}, "$.frames", "ends before it begins"),
        ({"frames": {"first": 1, "last": 999_999_999}}, "$", "999999999 renders, which are too many"),
        ({"varied": [{"place": "a", "values": [0] * 200}] * 2}, "$", "40000 renders, which are too many"),
        ({"frames": {"first": 1, "last": 1000}, "scene": {"name": "x" * 2**20}}, "$.scene", "have 1000 MiB"),
    ],
)
def test_too_many_are_told_before_any_is_made(more: dict[str, Any], place: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        members_of(**more)
    assert [each.place for each in refused.value.problems] == [place]


def test_many_values_make_no_document_larger() -> None:
    assert len(members_of(varied=[{"place": "tracing.seed", "values": [*range(10_000)]}])) == 10_000


async def create_group(rest: httpx.AsyncClient, body: dict[str, Any], **more: Any) -> httpx.Response:
    frames = {"first": 1, "last": 3}
    asked = {"name": "Room", "changes": {"sensor.position[0]": "0..1"}, "frames": frames}
    return await rest.post("/v1/groups", json={**body, **asked, **more})


async def test_a_group_is_made_once(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    answers = [await create_group(rest, body) for _ in range(2)]
    assert [each.status_code for each in answers] == [201, 201]
    first, again = (each.json() for each in answers)
    assert [each["id"] for each in first["renders"]] == [each["id"] for each in again["renders"]]
    assert [each["name"] for each in first["renders"]] == ["Room 1", "Room 2", "Room 3"]
    assert {each["group"] for each in first["renders"]} == {first["name"]}
    assert first["name"].startswith("Room ")
    assert len((await rest.get("/v1/renders")).json()["renders"]) == 3
    other = await create_group(rest, body, changes={"sensor.position[0]": "0..2"})
    assert other.status_code == 409


async def test_a_group_is_made_whole_or_not_at_all(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    """Which render is wrong is said, and where."""
    varied = [{"place": "sensor.position[1]", "values": [0, "high"]}]
    answer = await create_group(rest, body, frames=None, changes={}, varied=varied)
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == ["position[1]=high: $.sensor.position[1]"]
    elsewhere = [{"place": "surfaces[9].kernel", "values": [0, 1]}]
    answer = await create_group(rest, body, frames=None, changes={}, varied=elsewhere)
    assert [each["place"] for each in answer.json()["problems"]] == ["kernel=0: surfaces[9].kernel"]
    assert (await rest.get("/v1/renders")).json()["renders"] == []


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


def test_an_empty_folder_is_told(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["submit", str(tmp_path)])
    assert "no scene documents" in result.output + str(result.exception)
