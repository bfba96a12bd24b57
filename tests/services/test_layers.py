"""Layers of renders of a service: asked for, kept, told, and gone with the render."""

from typing import Any

import httpx
import numpy as np
import OpenEXR
from nocturne_api.files.current_image import write_current
from nocturne_coordinator.output.previews import layers_of
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.removal import delete_render, sweep
from nocturne_coordinator.store.unused import sweep_unused

from tests.services import coordinator_acts


async def test_are_made_once_and_told(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], tmp_path: Any
) -> None:
    answer = await rest.post("/v1/renders", json={**body, "layers": ["depth", "albedo", "depth"]})
    assert answer.status_code == 201, answer.text
    assert answer.json()["layers"] == ["albedo", "depth"]
    row = folder.renders.get(answer.json()["id"])
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
    layers = folder.renders.get(made[0]).layers_sha256
    assert folder.renders.get(made[1]).layers_sha256 == layers
    for render_id, left in zip(made, (True, False), strict=True):
        coordinator_acts.finish(folder, render_id)
        delete_render(folder, render_id)
        sweep(folder)
        assert (folder.blobs.here(layers) is not None) is left


async def test_an_image_does_without_where_their_file_is_gone(folder: DataFolder) -> None:
    assert layers_of(folder, "0" * 64).channels == {}
