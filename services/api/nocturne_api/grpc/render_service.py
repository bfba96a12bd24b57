"""nocturne.v1.RenderService over the operations."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import aclosing
from typing import Any

import grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_coordinator.dispatch.region import Region
from nocturne_scene.document.json_text import decode_json
from nocturne_scene.errors import InputError

from nocturne_api.grpc.failures import Answering
from nocturne_api.grpc.messages import (
    asked_stop,
    convergence_message,
    reading_message,
    render_message,
    webhook_message,
    worker_message,
)
from nocturne_api.operations.operations import Operations
from nocturne_api.operations.submission import CreateRequest
from nocturne_api.preflight.pool import PreflightSpec

Context = grpc.aio.ServicerContext[Any, Any]


class RenderService(render_service_pb2_grpc.RenderServiceServicer):
    """Takes messages apart, calls one operation, puts its answer into a message."""

    def __init__(self, operations: Operations) -> None:
        self._operations = operations

    async def CreateRender(self, request: pb.CreateRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            created = await self._operations.renders.create(
                CreateRequest(
                    request_id=request.request_id,
                    name=request.name,
                    scene=await asyncio.to_thread(decode_json, request.scene_json),
                    width=request.width,
                    height=request.height,
                    samples=request.samples,
                    stop=asked_stop(request.stop),
                    priority=request.priority,
                    layers=[*request.layers],
                    group=request.group,
                    after=request.after,
                    tags=[*request.tags],
                )
            )
            return render_message(created)

    async def Preflight(  # noqa: N802
        self, request: pb.PreflightRequest, context: Context
    ) -> pb.PreflightResponse:
        async with Answering(context):
            scene = await asyncio.to_thread(decode_json, request.scene_json)
            asked = PreflightSpec(scene, request.width, request.height, request.error, request.budget_seconds)
            report = await self._operations.preflights.run(asked)
            return pb.PreflightResponse(report_json=report.model_dump_json().encode())

    async def GetRender(self, request: pb.GetRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.renders.get(request.id))

    async def ListRenders(  # noqa: N802
        self, request: pb.ListRendersRequest, context: Context
    ) -> pb.ListRendersResponse:
        async with Answering(context):
            page = await self._operations.renders.list(
                request.page_size, request.page_token, request.group, request.tag, request.search
            )
            renders = [render_message(view) for view in page.renders]
            return pb.ListRendersResponse(renders=renders, next_page_token=page.next_page_token)

    async def CancelRender(self, request: pb.CancelRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.controls.cancel(request.id, request.request_id))

    async def DeleteRender(  # noqa: N802
        self, request: pb.DeleteRenderRequest, context: Context
    ) -> pb.DeleteRenderResponse:
        async with Answering(context):
            await self._operations.renders.delete(request.id, request.request_id)
            return pb.DeleteRenderResponse()

    async def PauseRender(self, request: pb.PauseRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.controls.pause(request.id))

    async def ResumeRender(self, request: pb.ResumeRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.controls.resume(request.id))

    async def ExtendRender(self, request: pb.ExtendRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            stop = asked_stop(request.stop)
            extend = self._operations.controls.extend
            return render_message(await extend(request.id, request.samples, stop, [*request.drop]))

    async def SetPriority(self, request: pb.SetPriorityRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.controls.set_priority(request.id, request.priority))

    async def SetTags(self, request: pb.SetTagsRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.controls.set_tags(request.id, [*request.tags]))

    async def LookFirst(self, request: pb.LookFirstRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            asked = request.region
            region = Region(asked.x, asked.y, asked.width, asked.height)
            wanted = region if request.HasField("region") else None
            return render_message(await self._operations.controls.look_first(request.id, wanted))

    async def ReplayRender(self, request: pb.ReplayRenderRequest, context: Context) -> pb.Render:  # noqa: N802
        async with Answering(context):
            return render_message(await self._operations.renders.replay(request.id, request.request_id))

    async def ExplainRender(  # noqa: N802
        self, request: pb.ExplainRenderRequest, context: Context
    ) -> pb.ExplainRenderResponse:
        async with Answering(context):
            explained = await self._operations.renders.explain(request.id)
            return pb.ExplainRenderResponse(sentence=explained.sentence)

    async def ReadRegion(self, request: pb.ReadRegionRequest, context: Context) -> pb.Reading:  # noqa: N802
        async with Answering(context):
            asked = request.region
            region = Region(asked.x, asked.y, asked.width, asked.height)
            wanted = region if asked.width or asked.height else None
            return reading_message(await self._operations.readings.read(request.id, wanted))

    async def GetConvergence(  # noqa: N802
        self, request: pb.GetConvergenceRequest, context: Context
    ) -> pb.GetConvergenceResponse:
        async with Answering(context):
            return convergence_message(await self._operations.renders.convergence(request.id))

    async def WatchRenders(  # noqa: N802
        self,
        request: pb.WatchRendersRequest,  # noqa: ARG002 - it is empty
        context: Context,
    ) -> AsyncIterator[pb.Render]:
        async with Answering(context), self._operations.streams.newest() as states:
            async for state in states:
                yield render_message(state)

    async def DrainWorker(  # noqa: N802
        self, request: pb.DrainWorkerRequest, context: Context
    ) -> pb.DrainWorkerResponse:
        async with Answering(context):
            await self._operations.workers.drain(request.id)
            return pb.DrainWorkerResponse()

    async def ReleaseWorker(  # noqa: N802
        self, request: pb.ReleaseWorkerRequest, context: Context
    ) -> pb.ReleaseWorkerResponse:
        async with Answering(context):
            await self._operations.workers.release(request.id)
            return pb.ReleaseWorkerResponse()

    async def WatchRender(  # noqa: N802
        self, request: pb.WatchRenderRequest, context: Context
    ) -> AsyncIterator[pb.Render]:
        async with Answering(context), self._operations.streams.one(request.id) as states:
            async for state in states:
                yield render_message(state)

    async def FetchImage(  # noqa: N802
        self, request: pb.FetchImageRequest, context: Context
    ) -> AsyncIterator[pb.ImageChunk]:
        openers = {
            pb.IMAGE_KIND_PREVIEW: self._operations.images.open_preview,
            pb.IMAGE_KIND_EXR: self._operations.images.open_exr,
        }
        async with Answering(context):
            if request.kind not in openers:
                raise InputError.at("kind", "expected one of IMAGE_KIND_PREVIEW, IMAGE_KIND_EXR")
            opened = await openers[request.kind](request.id)
            etag = opened.etag
            async with aclosing(opened.chunks()) as chunks:
                async for data in chunks:
                    yield pb.ImageChunk(data=data, etag=etag)
                    etag = ""

    async def ListWorkers(  # noqa: N802
        self,
        request: pb.ListWorkersRequest,  # noqa: ARG002 - it is empty
        context: Context,
    ) -> pb.ListWorkersResponse:
        async with Answering(context):
            found = await self._operations.workers.list()
            return pb.ListWorkersResponse(workers=[worker_message(view) for view in found.workers])

    async def CreateWebhook(self, request: pb.CreateWebhookRequest, context: Context) -> pb.Webhook:  # noqa: N802
        async with Answering(context):
            return webhook_message(await self._operations.webhooks.create(request.url))

    async def ListWebhooks(  # noqa: N802
        self,
        request: pb.ListWebhooksRequest,  # noqa: ARG002 - it is empty
        context: Context,
    ) -> pb.ListWebhooksResponse:
        async with Answering(context):
            found = await self._operations.webhooks.list()
            return pb.ListWebhooksResponse(webhooks=[webhook_message(view) for view in found.webhooks])

    async def DeleteWebhook(  # noqa: N802
        self, request: pb.DeleteWebhookRequest, context: Context
    ) -> pb.DeleteWebhookResponse:
        async with Answering(context):
            await self._operations.webhooks.delete(request.id)
            return pb.DeleteWebhookResponse()
