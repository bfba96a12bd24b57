"""Layers of renders of a service: asked for, kept, told, and gone with the render."""

import asyncio
import json
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import OpenEXR
import pytest
from nocturne_api.background.layer_builder import LayerBuilder
from nocturne_api.background.space import DiskQuota
from nocturne_api.compiling.pool import WARM_SCENE, CompileLimits, layers_in_child
from nocturne_api.files.current_image import write_current
from nocturne_coordinator.output.pictures import layers_of
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.layers import LayersDue
from nocturne_coordinator.store.removal import delete_render, sweep, sweep_unused
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import make_schedule

from tests.services import coordinator_acts

WARM_DOCUMENT = json.dumps(WARM_SCENE)


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not true():  # noqa: ASYNC110 - another process makes the layers
            await asyncio.sleep(0.02)


async def layers_of_render(folder: DataFolder, render_id: str) -> str:
    """Digest of the file, when it is made."""
    await until(lambda: bool(folder.renders.get(render_id).layers_sha256))
    return folder.renders.get(render_id).layers_sha256


async def test_are_made_once_and_told(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], tmp_path: Any
) -> None:
    answer = await rest.post("/v1/renders", json={**body, "layers": ["depth", "albedo", "depth"]})
    assert answer.status_code == 201, answer.text
    assert answer.json()["layers"] == ["albedo", "depth"]
    await layers_of_render(folder, answer.json()["id"])
    row = folder.renders.get(answer.json()["id"])
    assert folder.layers.due() == []
    sweep_unused(folder, -1.0)
    write_current(
        tmp_path / "image.exr",
        row,
        folder.renders.schedule(row.id),
        1,
        [],
        layers_of(folder, row.layers_sha256),
    )
    with OpenEXR.File(str(tmp_path / "image.exr"), separate_channels=True) as file:
        depth = file.channels()["depth.Z"].pixels
        assert file.header()["nocturne:objects"] == '["floor", "lamp"]'
    # The lamp is 2 m in front of the sensor, and its corner in the middle of the film.
    assert np.isclose(depth[14, 20], 2.0, atol=0.01)


async def test_that_there_are_not_are_refused(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    answer = await rest.post("/v1/renders", json={**body, "layers": ["ao"]})
    assert answer.status_code == 422
    [problem] = answer.json()["problems"]
    assert problem["place"] == "$.layers"


async def test_another_choice_is_another_request(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    assert (await rest.post("/v1/renders", json={**body, "layers": ["depth"]})).status_code == 201
    assert (await rest.post("/v1/renders", json={**body, "layers": ["depth"]})).status_code == 201
    assert (await rest.post("/v1/renders", json=body)).status_code == 409


async def test_go_with_the_last_render_that_has_them(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    made = [
        (await rest.post("/v1/renders", json={**body, "request_id": name, "layers": ["normal"]})).json()["id"]
        for name in ("one", "two")
    ]
    layers = await layers_of_render(folder, made[0])
    assert await layers_of_render(folder, made[1]) == layers
    for render_id, left in zip(made, (True, False), strict=True):
        coordinator_acts.finish(folder, render_id)
        delete_render(folder, render_id)
        sweep(folder)
        assert (folder.blobs.here(layers) is not None) is left


async def test_that_can_not_be_made_are_told_and_nothing_waits(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> str:
        raise InputError.at("$.layers", "can't be made, as nocturne-trace failed")

    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails)
    made = (await rest.post("/v1/renders", json={**body, "layers": ["normal"]})).json()
    await until(lambda: not folder.layers.due())
    told = (await rest.get(f"/v1/renders/{made['id']}")).json()
    assert told["layers"] == []
    sentence = "It has no layers: $.layers: can't be made, as nocturne-trace failed"
    assert told["warnings"] == [{"kind": "layers", "sentence": sentence, "parts": []}]


async def test_what_failed_for_now_is_tried_again(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[int] = []

    def fails_once(*asked: Any) -> str:
        tried.append(1)
        if len(tried) == 1:
            raise OSError("no space left")
        return layers_in_child(*asked)

    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails_once)
    monkeypatch.setattr("nocturne_api.background.layer_builder._AGAIN_S", 0.01)
    made = (await rest.post("/v1/renders", json={**body, "layers": ["normal"]})).json()
    await layers_of_render(folder, made["id"])
    assert len(tried) == 2


async def test_an_image_does_without_where_their_file_is_gone(folder: DataFolder) -> None:
    assert layers_of(folder, "0" * 64).channels == {}


async def test_who_has_many_keeps_nobody_else_waiting(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two places, and two owners with many older renders: a third one's layers come after one of each."""
    made: list[str] = []
    owners = ["ann", "bob", "ann", "bob", "ann", "bob", "carl"]
    for number, owner in enumerate(owners):
        queue_with_layers(folder, owner, f"{number}")

    def fails(*_: object) -> str:
        raise InputError.at("$.layers", "can't be made")

    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails)
    give_up = folder.layers.give_up

    def note(render_id: str, warning: str) -> None:
        made.append(folder.renders.get(render_id).owner)
        give_up(render_id, warning)

    monkeypatch.setattr(folder.layers, "give_up", note)
    maker = LayerBuilder(folder, asyncio.to_thread, CompileLimits(), DiskQuota(folder.root, 0.0))
    maker.start()
    await until(lambda: not folder.layers.due())
    await maker.close()
    assert sorted(made) == sorted(owners)
    assert "carl" in made[:4]


async def test_one_that_fails_for_now_holds_no_place(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two owners whose layers can't be made for now, and two places: a third one's are made."""
    failing = {queue_with_layers(folder, owner, owner) for owner in ("ann", "bob")}
    other = queue_with_layers(folder, "carl", "carl")
    get_due = folder.layers.get_due

    def get(render_id: str) -> LayersDue | None:
        if render_id in failing:
            raise OSError("no space left")
        return get_due(render_id)

    def fails(*_: object) -> str:
        raise InputError.at("$.layers", "can't be made")

    monkeypatch.setattr(folder.layers, "get_due", get)
    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails)
    maker = LayerBuilder(folder, asyncio.to_thread, CompileLimits(), DiskQuota(folder.root, 0.0))
    maker.start()
    await until(lambda: other not in {render_id for render_id, _ in folder.layers.due()})
    await maker.close()
    assert {render_id for render_id, _ in folder.layers.due()} == failing


@pytest.mark.parametrize("more_bytes", [-1, 1])
async def test_wait_for_room_in_a_bounded_folder(
    folder: DataFolder, monkeypatch: pytest.MonkeyPatch, more_bytes: int
) -> None:
    """Nothing is made beyond the bound; layers in progress count, and are reported to other requests."""
    render_id = queue_with_layers(folder, "ann", "one")
    size_bytes = 4 * 8 * 8
    space = DiskQuota(folder.root, 0.0)
    bound = space.figures()["data_bytes"] + size_bytes + more_bytes
    space = DiskQuota(folder.root, bound)
    begun: list[float] = []

    def fails(*_: object) -> str:
        begun.append(space.figures()["data_bytes"])
        raise InputError.at("$.layers", "can't be made")

    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails)
    monkeypatch.setattr("nocturne_api.background.layer_builder._AGAIN_S", 0.01)
    tried: list[str] = []
    get_due = folder.layers.get_due

    def get(due: str) -> LayersDue | None:
        tried.append(due)
        return get_due(due)

    monkeypatch.setattr(folder.layers, "get_due", get)
    maker = LayerBuilder(folder, asyncio.to_thread, CompileLimits(), space)
    maker.start()
    await until(lambda: len(tried) >= 3 or not folder.layers.due())
    await maker.close()
    assert [due for due, _ in folder.layers.due()] == ([render_id] if more_bytes < 0 else [])
    assert begun == ([] if more_bytes < 0 else [bound - more_bytes])


async def test_can_be_closed_when_a_render_comes_just_then(folder: DataFolder) -> None:
    """At every turn of the event loop after it came; a service could not be stopped."""

    async def nothing_is_due(*_: object) -> list[tuple[str, str]]:
        return []

    for turns in range(8):
        maker = LayerBuilder(folder, nothing_is_due, CompileLimits(), DiskQuota(folder.root, 0.0))
        maker.start()
        for _ in range(20):
            await asyncio.sleep(0)
        maker.wake()
        for _ in range(turns):
            await asyncio.sleep(0)
        # Not by a timeout, which would cancel it once more.
        closed, _ = await asyncio.wait([asyncio.create_task(maker.close())], timeout=3000)
        assert closed, turns


def test_what_was_cancelled_before_it_had_samples_needs_none(folder: DataFolder) -> None:
    render_id = queue_with_layers(folder, "ann", "one")
    assert folder.layers.due() == [(render_id, "ann")]
    folder.database.execute(
        "UPDATE render SET state = 'CANCELLED', ended = created WHERE id = ?", (render_id,)
    )
    assert folder.layers.due() == []
    folder.database.execute("UPDATE render SET photons = 1 WHERE id = ?", (render_id,))
    assert folder.layers.due() == [(render_id, "ann")]


def test_count_as_stored_before_they_are(folder: DataFolder) -> None:
    """Else whoever has a quota could have more by asking for many at once."""
    plain = folder.renders.create(new_render("plain")).id
    with_layers = queue_with_layers(folder, "ann", "layers")
    stored = {
        row["id"]: row["stored_bytes"] for row in folder.database.rows("SELECT id, stored_bytes FROM render")
    }
    # A separate file, and the image: 4 bytes of one channel of 8 x 8 pixels.
    assert stored[with_layers] - stored[plain] == 2 * 4 * 8 * 8


def new_render(request_id: str, owner: str = "ann", layers: tuple[str, ...] = ()) -> NewRender:
    schedule = make_schedule(8, 8, 4)
    return NewRender(request_id, "", "5c" * 32, WARM_DOCUMENT, 8, 8, 4, schedule, owner=owner, layers=layers)


def queue_with_layers(folder: DataFolder, owner: str, request_id: str) -> str:
    return folder.renders.create(new_render(request_id, owner, ("depth",))).id
