"""What each call of the gRPC contract asks of the operations, by the name of its method.

A call takes the message of its method, and answers with the model of REST, or, where REST answers with bytes,
with messages. Calls whose answers stream are asynchronous iterators.
"""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, aclosing
from typing import Any

from nocturne.v1 import asset_service_pb2, render_service_pb2
from nocturne_coordinator.dispatch.region import Region
from nocturne_scene.errors import InputError

from nocturne_api.grpc.conversion import body_of, given
from nocturne_api.models.assets import Asset
from nocturne_api.models.render_requests import CreateRenderRequest, StopRequest
from nocturne_api.models.renders import Render
from nocturne_api.models.scenes import PreflightRequest
from nocturne_api.operations.assets import Assets
from nocturne_api.operations.images import Images
from nocturne_api.operations.operations import Operations
from nocturne_api.operations.render_streams import States

Call = Callable[[Any], Awaitable[object] | AsyncIterator[object]]


def calls_of(operations: Operations) -> dict[str, Call]:
    """The calls of all services of the contract."""
    renders, controls, streams = operations.renders, operations.controls, operations.streams
    workers, webhooks, assets = operations.workers, operations.webhooks, operations.assets
    return {
        "CreateRender": lambda asked: _create(operations, asked),
        "Preflight": lambda asked: _preflight(operations, asked),
        "GetRender": lambda asked: renders.get(asked.id),
        "ListRenders": lambda asked: renders.list(
            asked.page_size, asked.page_token, asked.group, asked.tag, asked.search
        ),
        "CancelRender": lambda asked: controls.cancel(asked.id, asked.request_id),
        "DeleteRender": lambda asked: renders.delete(asked.id, asked.request_id),
        "PauseRender": lambda asked: controls.pause(asked.id),
        "ResumeRender": lambda asked: controls.resume(asked.id),
        "ExtendRender": lambda asked: controls.extend(
            asked.id, asked.samples, given(asked.stop, StopRequest), [*asked.drop]
        ),
        "SetPriority": lambda asked: controls.set_priority(asked.id, asked.priority),
        "SetTags": lambda asked: controls.set_tags(asked.id, [*asked.tags]),
        "LookFirst": lambda asked: controls.look_first(
            asked.id, _region(asked.region) if asked.HasField("region") else None
        ),
        "ReplayRender": lambda asked: renders.replay(asked.id, asked.request_id),
        "ExplainRender": lambda asked: renders.explain(asked.id),
        "ReadRegion": lambda asked: operations.readings.read(
            asked.id, _region(asked.region) if asked.region.width or asked.region.height else None
        ),
        "GetConvergence": lambda asked: renders.convergence(asked.id),
        "WatchRender": lambda asked: _watch(streams.one(asked.id)),
        "WatchRenders": lambda _: _watch(streams.newest()),
        "FetchImage": lambda asked: _fetch_image(operations.images, asked),
        "ListWorkers": lambda _: workers.list(),
        "DrainWorker": lambda asked: workers.drain(asked.id),
        "ReleaseWorker": lambda asked: workers.release(asked.id),
        "CreateWebhook": lambda asked: webhooks.create(asked.url),
        "ListWebhooks": lambda _: webhooks.list(),
        "DeleteWebhook": lambda asked: webhooks.delete(asked.id),
        "BatchMissing": lambda asked: assets.missing([*asked.sha256]),
        "Upload": lambda asked: _upload(assets, asked),
        "Fetch": lambda asked: _fetch(assets, asked.sha256),
        "Enrol": lambda asked: operations.machines.enrol(asked.node),
    }


async def _create(operations: Operations, asked: render_service_pb2.CreateRenderRequest) -> Render:
    return await operations.renders.create(await asyncio.to_thread(body_of, asked, CreateRenderRequest))


async def _preflight(
    operations: Operations, asked: render_service_pb2.PreflightRequest
) -> render_service_pb2.PreflightResponse:
    report = await operations.preflights.run(await asyncio.to_thread(body_of, asked, PreflightRequest))
    return render_service_pb2.PreflightResponse(report_json=report.model_dump_json().encode())


def _region(asked: render_service_pb2.Region) -> Region:
    return Region(asked.x, asked.y, asked.width, asked.height)


async def _watch(stream: AbstractAsyncContextManager[States]) -> AsyncIterator[Render]:
    async with stream as states:
        async for state in states:
            yield state


async def _fetch_image(
    images: Images, asked: render_service_pb2.FetchImageRequest
) -> AsyncIterator[render_service_pb2.ImageChunk]:
    openers = {
        render_service_pb2.IMAGE_KIND_PREVIEW: images.open_preview,
        render_service_pb2.IMAGE_KIND_EXR: images.open_exr,
    }
    if asked.kind not in openers:
        raise InputError.at("kind", "expected one of IMAGE_KIND_PREVIEW, IMAGE_KIND_EXR")
    opened = await openers[asked.kind](asked.id)
    etag = opened.etag
    async with aclosing(opened.chunks()) as chunks:
        async for data in chunks:
            yield render_service_pb2.ImageChunk(data=data, etag=etag)
            etag = ""


async def _upload(assets: Assets, requests: AsyncIterator[asset_service_pb2.UploadRequest]) -> Asset:
    first = await anext(requests, None)
    if first is None or first.WhichOneof("part") != "asset":
        raise InputError.at("asset", "the first message must say digest and size")
    return await assets.store(first.asset.sha256, first.asset.size_bytes, _data(requests))


async def _data(requests: AsyncIterator[asset_service_pb2.UploadRequest]) -> AsyncIterator[bytes]:
    async for request in requests:
        if request.WhichOneof("part") != "data":
            raise InputError.at("data", "after the first message only bytes are expected")
        yield request.data


async def _fetch(assets: Assets, sha256: str) -> AsyncIterator[asset_service_pb2.Chunk]:
    opened = await assets.open(sha256)
    total_bytes = opened.size_bytes
    if total_bytes == 0:
        yield asset_service_pb2.Chunk()
    async with aclosing(opened.chunks()) as chunks:
        async for data in chunks:
            yield asset_service_pb2.Chunk(data=data, total_bytes=total_bytes)
            total_bytes = 0
