"""A render that is deleted leaves nothing behind, and takes nothing from others."""

import asyncio
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import grpc
import httpx
import obstore
import pytest
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_api.service import Service, Settings, open_service
from nocturne_client import Client
from nocturne_client.cli.app import app
from nocturne_coordinator.errors import BlobsMissing, WrongState
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.database import Row
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.removal import delete_render, sweep
from nocturne_coordinator.store.renders import Renders
from nocturne_coordinator.store.sqlite import SqliteDatabase
from typer.testing import CliRunner

from tests.services import coordinator_acts
from tests.services.endpoints import rest_client, running

Stub = render_service_pb2_grpc.RenderServiceStub

PLY = b"""ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""
ASSET = hashlib.sha256(PLY).hexdigest()


@pytest.fixture
def body(body: dict[str, Any]) -> dict[str, Any]:
    """A create request whose scene has an uploaded mesh."""
    mesh = {"type": "mesh", "asset": f"sha256:{ASSET}", "format": "ply"}
    body["scene"]["surfaces"][0]["shape"] = mesh
    return body


async def ended(rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], name: str) -> str:
    """A render of the scene that has come to its end, with sums and images; gives its id."""
    await rest.put(f"/v1/assets/{ASSET}", content=PLY)
    answer = await rest.post("/v1/renders", json={**body, "request_id": name})
    assert answer.status_code == 201, answer.text
    render_id: str = answer.json()["id"]
    for table, values in {
        "error_point": "1.0, 1, 1.0, 0.5, 0.1, 7.0",
        "contribution": "1, 'w'",
        "failed_tile": "1, 0, 4, 'no', '[]'",
        "lease": "1, 1",
    }.items():
        folder.database.execute(f"INSERT INTO {table} VALUES (?, {values})", (render_id,))  # noqa: S608
    folder.database.execute(
        "INSERT INTO tile VALUES (?, 1, 8, ?, 1, 0, 0.0, ?, ?)", (render_id, b"\0", b"", b"")
    )
    folder.database.execute("INSERT INTO at_work VALUES (1, ?, 0, 'w', 0)", (render_id,))
    coordinator_acts.picture(folder, render_id, b"a preview")
    folder.image_path(render_id).write_bytes(b"an image")
    coordinator_acts.finish(folder, render_id)
    return render_id


def mentions(folder: DataFolder, render_id: str) -> set[str]:
    """Tables that have the id anywhere."""
    tables: Sequence[Row]
    if isinstance(folder.database, SqliteDatabase):
        tables = folder.database.rows("SELECT name FROM sqlite_master WHERE type = 'table'")
    else:
        tables = folder.database.rows("SELECT tablename AS name FROM pg_tables WHERE schemaname = 'nocturne'")
    return {
        name
        for name in (table["name"] for table in tables)
        for row in folder.database.rows(f'SELECT * FROM "{name}"')  # noqa: S608
        if render_id in [*row]
    }


def files_of(folder: DataFolder) -> set[str]:
    """All but the database."""
    found = (path for path in folder.root.rglob("*") if path.is_file())
    return {
        path.name for path in found if not path.name.startswith(("nocturne.db", "postgresql", "coordinator"))
    }


async def test_nothing_is_left(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = await ended(rest, folder, body, "a")
    assert {"render", "tile", "error_point", "contribution", "failed_tile", "lease", "at_work"} <= mentions(
        folder, render_id
    )
    assert len(files_of(folder)) == 7, "mesh, packed mesh, two notes on it, scene, preview, image"
    answer = await rest.delete(f"/v1/renders/{render_id}")
    assert (answer.status_code, answer.content) == (204, b"")
    assert mentions(folder, render_id) == {"call"}
    assert files_of(folder) == set()
    assert not (folder.root / "images" / render_id).exists()
    call = folder.calls.last(1)[0]
    assert (call["what"], call["render_id"], call["outcome"]) == ("delete", render_id, "done")
    for gone in (await rest.delete(f"/v1/renders/{render_id}"), await rest.get(f"/v1/renders/{render_id}")):
        assert (gone.status_code, gone.json()["reason"]) == (404, "NOT_FOUND")
    again = await ended(rest, folder, body, "a")
    await Stub(channel).DeleteRender(pb.DeleteRenderRequest(id=again, request_id="tidy"))
    assert folder.calls.last(1)[0]["request_id"] == "tidy"
    assert files_of(folder) == set()


async def test_what_runs_is_cancelled_first(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    await rest.put(f"/v1/assets/{ASSET}", content=PLY)
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    for act, state in (("", "QUEUED"), (":pause", "PAUSED")):
        if act:
            await rest.post(f"/v1/renders/{render_id}{act}")
        answer = await rest.delete(f"/v1/renders/{render_id}")
        assert (answer.status_code, answer.json()["reason"]) == (409, "WRONG_STATE")
        assert answer.json()["detail"] == f"{render_id} is {state}; cancel it before it is deleted"
    assert folder.removals.open() == []
    await rest.post(f"/v1/renders/{render_id}:cancel")
    assert (await rest.delete(f"/v1/renders/{render_id}")).status_code == 204
    assert mentions(folder, render_id) == {"call"}


async def test_what_others_use_stays(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    """A render of the same scene, then one of another scene with the same mesh, and a file of nobody's."""
    first, same = [await ended(rest, folder, body, name) for name in ("a", "b")]
    body["scene"]["sensor"]["position"] = [0, 0, 5]
    other = await ended(rest, folder, body, "c")
    lonely = b"uploaded for a render to come"
    await rest.put(f"/v1/assets/{hashlib.sha256(lonely).hexdigest()}", content=lonely)
    scene = folder.renders.get(first).scene_sha256
    packed = set(folder.blob_use.of(first)) - {scene, ASSET}
    assert len(packed) == 1
    await rest.delete(f"/v1/renders/{first}")
    assert {scene, ASSET, *packed} <= files_of(folder)
    await rest.delete(f"/v1/renders/{same}")
    assert scene not in files_of(folder)
    assert {ASSET, *packed} <= files_of(folder)
    assert (await rest.get(f"/v1/renders/{other}/image.exr")).content == b"an image"
    await rest.delete(f"/v1/renders/{other}")
    assert files_of(folder) == {hashlib.sha256(lonely).hexdigest()}


async def test_a_crash_in_between_is_made_good(body: dict[str, Any], web: Path, tmp_path: Path) -> None:
    folder = DataFolder(tmp_path / "data")
    try:
        async with running(tmp_path, web) as service, rest_client(service) as rest:
            render_id = await ended(rest, folder, body, "a")
        delete_render(folder, render_id)
        assert mentions(folder, render_id) == {"call", "removal"}
        assert len(files_of(folder)) == 7
        async with running(tmp_path, web):
            for _ in range(2000):
                if not folder.removals.open():
                    break
                await asyncio.sleep(0.05)
        assert folder.removals.open() == []
        assert files_of(folder) == set()
    finally:
        folder.close()


async def test_a_scene_whose_files_went_meanwhile_is_compiled_again(
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    folder: DataFolder,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Deleted after the new render's compile found all of them there, and before it was made."""
    body["scene"]["surfaces"][0]["shape"] = {
        "type": "mesh",
        "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        "triangles": [[0, 1, 2]],
    }
    first = await ended(rest, folder, body, "a")
    create_all = Renders.create_all
    refused: list[BlobsMissing] = []

    def late(self: Renders, new: Any, quota: Any) -> Any:
        if not refused:
            delete_render(folder, first)
            sweep(folder)
        try:
            return create_all(self, new, quota)
        except BlobsMissing as gone:
            refused.append(gone)
            raise

    monkeypatch.setattr(Renders, "create_all", late)
    answer = await rest.post("/v1/renders", json={**body, "request_id": "b"})
    assert answer.status_code == 201, answer.text
    assert len(refused) == 1
    assert all(folder.blobs.here(each) for each in folder.blob_use.of(answer.json()["id"]))


async def test_the_object_store_forgets_it_too(tmp_path: Path, body: dict[str, Any]) -> None:
    objects = ObjectStore(f"file://{tmp_path}/objects")
    settings = Settings(data=tmp_path / "data", web=tmp_path, port=0, grpc_port=0, objects=objects.url)
    service = await open_service(settings)
    await service.start()
    folder = DataFolder(tmp_path / "data")
    try:
        async with rest_client(service) as rest:
            first, second = [await ended(rest, folder, body, name) for name in ("a", "b")]
            folder.database.execute("UPDATE render SET image_final = 1")
            for _ in range(400):
                if len(folder.archive.renders()) == 2:
                    break
                await asyncio.sleep(0.05)

            def names() -> list[str]:
                return [each["path"] for batch in obstore.list(objects._store) for each in batch]

            assert sum(name.startswith(f"images/{first}/") for name in names()) == 2
            await rest.delete(f"/v1/renders/{first}")
            assert not any(name.startswith(f"images/{first}") for name in names())
            assert sum(name.startswith("blobs/") for name in names()) == 3
            await rest.delete(f"/v1/renders/{second}")
            assert names() == []
    finally:
        folder.close()
        await service.stop()


def test_a_render_that_goes_on_meanwhile_is_not_deleted(tmp_path: Path) -> None:
    """Extended between the look and the transaction."""
    from nocturne_coordinator.store.rows import NewRender
    from nocturne_scene.ranges import make_schedule

    folder = DataFolder(tmp_path)
    try:
        new = NewRender("q", "", "5c" * 32, "{}", 32, 32, 8, make_schedule(32, 32, 8))
        render_id = folder.renders.create(new).id
        with pytest.raises(WrongState):
            delete_render(folder, render_id)
        assert folder.removals.open() == []
        coordinator_acts.finish(folder, render_id)
        delete_render(folder, render_id)
        sweep(folder)
        assert mentions(folder, render_id) == set()
    finally:
        folder.close()


async def test_client_and_command_line(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder, service: Service
) -> None:
    first, second = [await ended(rest, folder, body, name) for name in ("a", "b")]
    url = f"http://127.0.0.1:{service.port}"
    with Client(url) as client:
        await asyncio.to_thread(client.delete, first)
    result = await asyncio.to_thread(CliRunner().invoke, app, ["delete", second], env={"NOCTURNE_URL": url})
    assert (result.exit_code, result.output) == (0, "")
    assert json.loads((await rest.get("/v1/renders")).text)["renders"] == []
