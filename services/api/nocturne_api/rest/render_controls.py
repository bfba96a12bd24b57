"""Changing renders that are there: cancel, pause, resume, extend, and what goes first."""

from fastapi import APIRouter, Request
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.errors import AmbiguousId, QuotaUsedUp, WrongState
from nocturne_scene.errors import NotFound

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.models.renders import (
    ExtendRenderRequest,
    LookFirstRequest,
    Render,
    RenderActionRequest,
    SetPriorityRequest,
    SetTagsRequest,
)
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.contract import body_of, errors

router = APIRouter(prefix="/v1/renders", tags=["renders"])

_ACTION = body_of(RenderActionRequest, required=False)
_OF_ONE = errors(NotFound, AmbiguousId)
_OF_ONE_IN_A_STATE = errors(NotFound, AmbiguousId, WrongState)


@router.post("/{render_id}:cancel", openapi_extra=_ACTION, responses=_OF_ONE)
async def cancel_render(render_id: str, request: Request, operations: Service) -> Render:
    """Stops a render; what was merged stays and can be fetched. Changes nothing on an ended render."""
    body = await _action(request)
    return await operations.controls.cancel(render_id, body.request_id)


@router.post("/{render_id}:pause", openapi_extra=_ACTION, responses=_OF_ONE_IN_A_STATE)
async def pause_render(render_id: str, request: Request, operations: Service) -> Render:
    """No more work until it is resumed; what is merged stays."""
    await _action(request)
    return await operations.controls.pause(render_id)


@router.post("/{render_id}:resume", openapi_extra=_ACTION, responses=_OF_ONE_IN_A_STATE)
async def resume_render(render_id: str, request: Request, operations: Service) -> Render:
    """Goes on with a paused render; with a degraded one, by tracing its failed tiles again."""
    await _action(request)
    return await operations.controls.resume(render_id)


@router.post(
    "/{render_id}:extend",
    openapi_extra=body_of(ExtendRenderRequest),
    responses=errors(NotFound, AmbiguousId, WrongState, QuotaUsedUp),
)
async def extend_render(render_id: str, request: Request, operations: Service) -> Render:
    """More samples or other conditions, also after the end; what is not named stays as it is."""
    body = await read_json(request, ExtendRenderRequest, SMALL_BODY_BYTES)
    return await operations.controls.extend(render_id, body.samples, body.stop, body.drop)


@router.post("/{render_id}:setPriority", openapi_extra=body_of(SetPriorityRequest), responses=_OF_ONE)
async def set_priority(render_id: str, request: Request, operations: Service) -> Render:
    """The render's weight among those of its owner."""
    body = await read_json(request, SetPriorityRequest, SMALL_BODY_BYTES)
    return await operations.controls.set_priority(render_id, body.priority)


@router.post("/{render_id}:setTags", openapi_extra=body_of(SetTagsRequest), responses=_OF_ONE)
async def set_tags(render_id: str, request: Request, operations: Service) -> Render:
    """Words to sort renders by, instead of those that it has."""
    body = await read_json(request, SetTagsRequest, SMALL_BODY_BYTES)
    return await operations.controls.set_tags(render_id, body.tags)


@router.post("/{render_id}:lookFirst", openapi_extra=body_of(LookFirstRequest), responses=_OF_ONE)
async def look_first(render_id: str, request: Request, operations: Service) -> Render:
    """Which part of the film gets its samples first; the finished image has the same bits with or without."""
    body = await read_json(request, LookFirstRequest, SMALL_BODY_BYTES)
    region = Region(body.x, body.y, body.width, body.height)
    return await operations.controls.look_first(render_id, region if region.width or region.height else None)


async def _action(request: Request) -> RenderActionRequest:
    """A body that may be left out."""
    has_body = request.headers.get("content-length", "0") != "0" or "transfer-encoding" in request.headers
    return (
        await read_json(request, RenderActionRequest, SMALL_BODY_BYTES) if has_body else RenderActionRequest()
    )
