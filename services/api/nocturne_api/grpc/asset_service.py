"""nocturne.v1.AssetService over the operations."""

from collections.abc import AsyncIterator
from contextlib import aclosing
from typing import Any

import grpc
from nocturne.v1 import asset_service_pb2 as pb
from nocturne.v1 import asset_service_pb2_grpc
from nocturne_scene.errors import InputError

from nocturne_api.grpc.failures import Answering
from nocturne_api.grpc.messages import asset_message
from nocturne_api.operations.operations import Operations

Context = grpc.aio.ServicerContext[Any, Any]


class AssetService(asset_service_pb2_grpc.AssetServiceServicer):
    """Takes messages apart, calls one operation, puts its answer into a message."""

    def __init__(self, operations: Operations) -> None:
        self._operations = operations

    async def BatchMissing(  # noqa: N802
        self, request: pb.BatchMissingRequest, context: Context
    ) -> pb.BatchMissingResponse:
        async with Answering(context):
            return pb.BatchMissingResponse(sha256=await self._operations.assets.missing(list(request.sha256)))

    async def Upload(self, requests: AsyncIterator[pb.UploadRequest], context: Context) -> pb.Asset:  # noqa: N802
        async with Answering(context):
            first = await anext(requests, None)
            if first is None or first.WhichOneof("part") != "asset":
                raise InputError.at("asset", "the first message must say digest and size")
            stored = await self._operations.assets.store(
                first.asset.sha256, first.asset.size_bytes, _data(requests)
            )
            return asset_message(stored)

    async def Fetch(self, request: pb.FetchRequest, context: Context) -> AsyncIterator[pb.Chunk]:  # noqa: N802
        async with Answering(context):
            opened = await self._operations.assets.open(request.sha256)
            total_bytes = opened.size_bytes
            if total_bytes == 0:
                yield pb.Chunk()
            async with aclosing(opened.chunks()) as chunks:
                async for data in chunks:
                    yield pb.Chunk(data=data, total_bytes=total_bytes)
                    total_bytes = 0


async def _data(requests: AsyncIterator[pb.UploadRequest]) -> AsyncIterator[bytes]:
    async for request in requests:
        if request.WhichOneof("part") != "data":
            raise InputError.at("data", "after the first message only bytes are expected")
        yield request.data
