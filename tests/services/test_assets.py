"""Files by content through both endpoints: a mismatch leaves nothing behind."""

import asyncio
import hashlib
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import grpc
import httpx
import pytest
from nocturne.v1 import asset_service_pb2 as pb
from nocturne.v1 import asset_service_pb2_grpc
from nocturne_api.service import Service

from tests.services.endpoints import refusal_of_upload

CONTENT = bytes(range(256)) * 10_000
SHA256 = hashlib.sha256(CONTENT).hexdigest()
OTHER = "0" * 64

Stub = asset_service_pb2_grpc.AssetServiceStub


def _files(tmp_path: Path) -> list[Path]:
    return [path for path in (tmp_path / "data" / "blobs").rglob("*") if path.is_file()]


def _messages(sha256: str, size: int, content: bytes, piece: int = 100_000) -> Iterator[pb.UploadRequest]:
    yield pb.UploadRequest(asset=pb.Asset(sha256=sha256, size_bytes=size))
    for start in range(0, len(content), piece):
        yield pb.UploadRequest(data=content[start : start + piece])


async def test_rest_in_grpc_out(rest: httpx.AsyncClient, channel: grpc.aio.Channel) -> None:
    asked = {"sha256": [SHA256, OTHER, SHA256]}
    assert (await rest.post("/v1/assets:batchMissing", json=asked)).json() == {"sha256": [SHA256, OTHER]}
    for _ in range(2):
        stored = await rest.put(f"/v1/assets/{SHA256}", content=CONTENT)
        assert stored.json() == {"sha256": SHA256, "size_bytes": len(CONTENT)}
    assert (await rest.head(f"/v1/assets/{SHA256}")).headers["content-length"] == str(len(CONTENT))
    assert (await rest.post("/v1/assets:batchMissing", json=asked)).json() == {"sha256": [OTHER]}

    chunks = [chunk async for chunk in Stub(channel).Fetch(pb.FetchRequest(sha256=SHA256))]
    assert b"".join(chunk.data for chunk in chunks) == CONTENT
    assert [chunk.total_bytes for chunk in chunks] == [len(CONTENT)] + [0] * (len(chunks) - 1)


async def test_grpc_in_rest_out(rest: httpx.AsyncClient, channel: grpc.aio.Channel) -> None:
    stored = await Stub(channel).Upload(_messages(SHA256, len(CONTENT), CONTENT))
    assert stored.size_bytes == len(CONTENT)
    assert (await rest.head(f"/v1/assets/{SHA256}")).status_code == 200
    missing = await Stub(channel).BatchMissing(pb.BatchMissingRequest(sha256=[OTHER, SHA256]))
    assert list(missing.sha256) == [OTHER]


async def test_wrong_digest_at_rest(rest: httpx.AsyncClient, tmp_path: Path) -> None:
    answer = await rest.put(f"/v1/assets/{OTHER}", content=CONTENT)
    assert answer.status_code == 422
    assert SHA256 in answer.json()["detail"]
    assert _files(tmp_path) == []


@pytest.mark.parametrize(
    ("sha256", "size"),
    [(OTHER, len(CONTENT)), (SHA256, len(CONTENT) - 1), (SHA256, len(CONTENT) + 1)],
)
async def test_mismatch_at_grpc(sha256: str, size: int, service: Service, tmp_path: Path) -> None:
    refused = await refusal_of_upload(service, _messages(sha256, size, CONTENT))
    assert refused == grpc.StatusCode.INVALID_ARGUMENT
    assert _files(tmp_path) == []


async def test_too_large_is_refused_by_its_head(service: Service, tmp_path: Path) -> None:
    head, *_ = _messages(SHA256, 2**63, CONTENT)
    assert await refusal_of_upload(service, iter([head])) == grpc.StatusCode.INVALID_ARGUMENT
    assert _files(tmp_path) == []


async def test_uploads_without_a_head_or_with_two(service: Service, tmp_path: Path) -> None:
    head, data, *_ = _messages(SHA256, len(CONTENT), CONTENT)
    for messages in ([], [data], [head, head]):
        assert await refusal_of_upload(service, iter(messages)) == grpc.StatusCode.INVALID_ARGUMENT
    assert _files(tmp_path) == []


async def test_size_must_be_declared_and_bounded(rest: httpx.AsyncClient, tmp_path: Path) -> None:
    async def chunked() -> AsyncIterator[bytes]:
        yield CONTENT

    answer = await rest.put(f"/v1/assets/{SHA256}", content=chunked())
    assert (answer.status_code, answer.json()["problems"][0]["place"]) == (422, "Content-Length")
    assert _files(tmp_path) == []


async def test_too_large_is_refused_before_it_is_sent(service: Service, tmp_path: Path) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", service.port)
    head = f"PUT /v1/assets/{SHA256} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {5 * 2**30}\r\n\r\n"
    writer.write(head.encode() + CONTENT)
    async with asyncio.timeout(5):
        assert (await reader.readline()).split()[1] == b"422"
    writer.close()
    assert _files(tmp_path) == []


async def test_a_cancelled_upload_leaves_nothing(
    channel: grpc.aio.Channel, tmp_path: Path, rest: httpx.AsyncClient
) -> None:
    call = Stub(channel).Upload()
    for message in list(_messages(SHA256, len(CONTENT), CONTENT))[:15]:
        await call.write(message)
    call.cancel()
    for _ in range(100):
        answered = await rest.get("/readyz?exclude=merging")
        if not _files(tmp_path):
            break
    assert answered.status_code == 200
    assert _files(tmp_path) == []


@pytest.mark.parametrize("digest", ["abc", "A" * 64, "..%2F..%2Fsecret", "g" * 64])
async def test_bad_digests(digest: str, rest: httpx.AsyncClient, channel: grpc.aio.Channel) -> None:
    assert (await rest.put(f"/v1/assets/{digest}", content=b"x")).status_code in (404, 422)
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        async for _ in Stub(channel).Fetch(pb.FetchRequest(sha256=digest)):
            pass
    assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT


async def test_fetch_of_what_is_not_there(channel: grpc.aio.Channel) -> None:
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        async for _ in Stub(channel).Fetch(pb.FetchRequest(sha256=OTHER)):
            pass
    assert caught.value.code() == grpc.StatusCode.NOT_FOUND
