"""The object store: a folder, and a server that speaks S3."""

import asyncio
import hashlib
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import obstore
import pytest
from nocturne_api.compiling import pool as compiling
from nocturne_api.service import Settings, open_service
from nocturne_coordinator.errors import ObjectDamaged, ObjectStoreUnavailable
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError, NotFound

from tests.services import coordinator_acts
from tests.services.endpoints import rest_client
from tests.services.s3_server import S3Server
from tests.system.waiting import LIMIT_S

DATA = b"a scene that is a scene is a scene" * 1000
SHA256 = hashlib.sha256(DATA).hexdigest()


@pytest.fixture
def s3(monkeypatch: pytest.MonkeyPatch) -> Iterator[S3Server]:
    server = S3Server("night", "someone")
    for name, value in {
        "AWS_ENDPOINT_URL": server.url,
        "AWS_ACCESS_KEY_ID": "someone",
        "AWS_SECRET_ACCESS_KEY": "something",
        "AWS_REGION": "us-east-1",
    }.items():
        monkeypatch.setenv(name, value)
    # What compiles has the environment that it was started with.
    compiling.stop()
    yield server
    server.stop()
    compiling.stop()


@pytest.fixture(params=["file", "s3"])
def objects(request: pytest.FixtureRequest, tmp_path: Path) -> ObjectStore:
    if request.param == "s3":
        request.getfixturevalue("s3")
        return ObjectStore("s3://night/renders/of")
    return ObjectStore(f"file://{tmp_path}/objects")


def _damage(objects: ObjectStore, name: str, data: bytes) -> None:
    obstore.put(objects._store, name, data)


def test_what_goes_in_comes_out(objects: ObjectStore, tmp_path: Path) -> None:
    (tmp_path / "in").write_bytes(DATA)
    assert objects.size("a/b") is None
    with pytest.raises(NotFound):
        objects.get("a/b", tmp_path / "out", SHA256, 10**6)
    for _ in range(2):
        objects.put("a/b", tmp_path / "in")
        assert objects.size("a/b") == len(DATA)
    objects.get("a/b", tmp_path / "out", SHA256, 10**6)
    assert (tmp_path / "out").read_bytes() == DATA


def test_damage_is_found_and_leaves_nothing(objects: ObjectStore, tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    for damaged in (DATA[:-1] + b"x", DATA[:-1], b"", DATA + DATA):
        _damage(objects, "a/b", damaged)
        with pytest.raises(ObjectDamaged):
            objects.get("a/b", tmp_path / "here" / "out", SHA256, len(DATA))
    assert list((tmp_path / "here").iterdir()) == []


def test_blobs_come_back_from_the_object_store(objects: ObjectStore, tmp_path: Path) -> None:
    first = BlobStore(tmp_path / "first", objects)
    assert first.put(DATA) == SHA256
    second = BlobStore(tmp_path / "second", objects)
    assert second.has(SHA256)
    assert second.missing([SHA256, "0" * 64]) == ["0" * 64]
    assert second.path(SHA256).read_bytes() == DATA
    with pytest.raises(NotFound):
        second.path("0" * 64)
    _damage(objects, f"blobs/{SHA256[:2]}/{SHA256}", b"something else")
    third = BlobStore(tmp_path / "third", objects)
    with pytest.raises(ObjectDamaged):
        third.path(SHA256)
    # A file in the local folder needs no object store.
    assert first.path(SHA256).read_bytes() == DATA


def test_a_blob_that_can_not_be_put_there_is_not_said_to_be_here(s3: S3Server, tmp_path: Path) -> None:
    blobs = BlobStore(tmp_path / "blobs", ObjectStore("s3://night/x"))
    s3.stop()
    with pytest.raises(ObjectStoreUnavailable), blobs.writer(SHA256, len(DATA)) as writer:
        writer.write(DATA)
    assert not BlobStore(tmp_path / "blobs").has(SHA256)


@pytest.mark.parametrize(
    "url", ["", "s3://", "s3:///x", "http://example.org/b", "file://relative", "memory:///", "s3://b/?x=1"]
)
def test_other_addresses_are_refused(url: str) -> None:
    with pytest.raises(InputError, match="expected s3://BUCKET/PREFIX"):
        ObjectStore(url)


async def test_a_service_that_lost_its_files_has_them_still(
    objects: ObjectStore, tmp_path: Path, body: dict[str, Any]
) -> None:
    """Upload, compile, finish; then the data folder's files are gone: scene, mesh and images come back."""
    data = tmp_path / "data"
    service = await open_service(Settings(data=data, web=tmp_path, port=0, grpc_port=0, objects=objects.url))
    await service.start()
    folder = DataFolder(data)
    try:
        async with rest_client(service) as rest:
            assert (await rest.put(f"/v1/assets/{SHA256}", content=DATA)).status_code == 200
            created = await rest.post("/v1/renders", json=body)
            assert created.status_code == 201, created.text
            render = created.json()
            coordinator_acts.picture(folder, render["id"], b"a preview")
            folder.image_path(render["id"]).write_bytes(b"an image")
            coordinator_acts.finish(folder, render["id"])
            folder.database.execute("UPDATE render SET image_final = 1 WHERE id = ?", (render["id"],))
            deadline = time.monotonic() + LIMIT_S
            while not folder.archive.renders():
                assert time.monotonic() < deadline
                await asyncio.sleep(0.05)
            assert list(data.glob(".archive-*")) == []
            for file in [*data.glob("blobs/??/*"), *data.glob("images/*/*")]:
                file.unlink()
            assert (await rest.head(f"/v1/assets/{SHA256}")).headers["content-length"] == str(len(DATA))
            image = await rest.get(f"/v1/renders/{render['id']}/image.exr")
            assert (image.status_code, image.content) == (200, b"an image")
            assert (await rest.get(f"/v1/renders/{render['id']}/preview.png")).content == b"a preview"
            assert folder.blobs.missing([render["scene_sha256"]]) == [render["scene_sha256"]]
            # Compiles without a word: its scene's blobs are in the object store.
            again = await rest.post("/v1/renders", json={**body, "request_id": "second"})
            assert (again.status_code, again.json()["scene_sha256"]) == (201, render["scene_sha256"])
            archived = folder.archive.file(render["id"], "image.exr")
            assert archived is not None
            assert archived.sha256 == hashlib.sha256(b"an image").hexdigest()
            _damage(objects, archived.name(render["id"], "image.exr"), b"no image")
            folder.image_path(render["id"]).unlink()
            refused = await rest.get(f"/v1/renders/{render['id']}/image.exr")
            assert (refused.status_code, refused.json()["reason"]) == (503, "STORE")
    finally:
        folder.close()
        await service.stop()


async def test_an_object_store_that_is_away_is_said_to_be(
    s3: S3Server, tmp_path: Path, body: dict[str, Any]
) -> None:
    settings = Settings(data=tmp_path / "data", web=tmp_path, port=0, grpc_port=0, objects="s3://night")
    service = await open_service(settings)
    await service.start()
    try:
        s3.stop()
        async with rest_client(service) as rest:
            for answer in (
                await rest.put(f"/v1/assets/{SHA256}", content=DATA),
                await rest.post("/v1/renders", json=body, timeout=90),
            ):
                assert (answer.status_code, answer.json()["reason"]) == (503, "STORE"), answer.text
            assert (await rest.get("/v1/renders")).json()["renders"] == []
    finally:
        await service.stop()
