"""Glare of renders and files whose luminaires are told: the layer is made without being asked for."""

import asyncio
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.errors import InputError

WIDTH, HEIGHT = 128, 64
PANORAMA = {"type": "panorama", "position": [0, 0, 4], "look_at": [0, 0, 0]}


@pytest.fixture
def body(body: dict[str, Any]) -> dict[str, Any]:
    body["scene"]["sensor"] = dict(PANORAMA)
    return {**body, "width": WIDTH, "height": HEIGHT}


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not true():  # noqa: ASYNC110 - another process makes the layers
            await asyncio.sleep(0.02)


async def test_what_is_made_without_being_asked_for_is_no_part_of_the_request(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its making may fail, and the request is still the same."""

    def fails(*_: object) -> str:
        raise InputError.at("$.layers", "can't be made, as nocturne-trace failed")

    monkeypatch.setattr("nocturne_api.background.layers_maker.layers_in_child", fails)
    made = (await rest.post("/v1/renders", json=body)).json()
    await until(lambda: not folder.layers.due())
    assert (await rest.get(f"/v1/renders/{made['id']}")).json()["layers"] == []
    again = await rest.post("/v1/renders", json=body)
    assert (again.status_code, again.json()["id"]) == (201, made["id"])


async def test_layers_that_are_asked_for_are_beside_it(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    made = (await rest.post("/v1/renders", json={**body, "layers": ["depth"]})).json()
    assert made["layers"] == ["depth", "emission"]
    large = {**body, "request_id": "large", "width": 4096, "height": 2048}
    assert (await rest.post("/v1/renders", json=large)).json()["layers"] == []
