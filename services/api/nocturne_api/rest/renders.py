"""Renders: create, list, read, change, replay, delete; their groups."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.errors import AmbiguousId, Conflict, QuotaUsedUp, WrongState
from nocturne_scene.errors import NotFound
from starlette.responses import Response

from nocturne_api.errors import FolderFull, Overloaded
from nocturne_api.limits import CREATE_BODY_BYTES, SMALL_BODY_BYTES
from nocturne_api.models.render_requests import (
    CreateGroupRequest,
    CreateRenderRequest,
    ExtendRenderRequest,
    LookFirstRequest,
    RenderActionRequest,
    ReplayRenderRequest,
    SetPriorityRequest,
    SetTagsRequest,
)
from nocturne_api.models.renders import (
    Baselines,
    Convergence,
    Explanation,
    Group,
    NewGroup,
    Render,
    RenderPage,
    TilesInProgress,
)
from nocturne_api.rest.contract import body_of, errors
from nocturne_api.rest.requests import Service, read_json

router = APIRouter(prefix="/v1", tags=["renders"])

_ACTION = body_of(RenderActionRequest, required=False)
_OF_NEW = errors(Conflict, QuotaUsedUp, FolderFull, Overloaded)
_OF_ONE = errors(NotFound, AmbiguousId)
_OF_ONE_IN_A_STATE = errors(NotFound, AmbiguousId, WrongState)


@router.post(
    "/renders",
    status_code=201,
    openapi_extra=body_of(CreateRenderRequest),
    responses=_OF_NEW,
)
async def create_render(request: Request, operations: Service) -> Render:
    """Submits a scene. Repeating a request_id gives back the render made before."""
    return await operations.renders.create(await read_json(request, CreateRenderRequest, CREATE_BODY_BYTES))


@router.get("/renders")
async def list_renders(
    operations: Service,
    page_size: Annotated[int, Query(description="At most 200; 0 means 50.")] = 0,
    page_token: Annotated[str, Query(description="From the page before.")] = "",
    group: Annotated[str, Query(description="Of this group only.")] = "",
    tag: Annotated[str, Query(description="With this tag only.")] = "",
    search: Annotated[
        str,
        Query(description="With all these words in name, id, owner, state, group or tags.", max_length=200),
    ] = "",
) -> RenderPage:
    """One page of renders, newest first."""
    return await operations.renders.list(page_size, page_token, group, tag, search)


@router.get("/renders/{render_id}", responses=_OF_ONE)
async def get_render(render_id: str, operations: Service) -> Render:
    """One render, by its id or the beginning of it."""
    return await operations.renders.get(render_id)


@router.delete(
    "/renders/{render_id}", status_code=204, response_class=Response, responses=errors(NotFound, WrongState)
)
async def delete_render(render_id: str, operations: Service) -> Response:
    """Forgets a render that has ended, with its images and the files that no other render uses."""
    await operations.renders.delete(render_id)
    return Response(status_code=204)


@router.post(
    "/renders/{render_id}:replay",
    status_code=201,
    openapi_extra=body_of(ReplayRenderRequest),
    responses=errors(NotFound, AmbiguousId, Conflict, QuotaUsedUp, FolderFull, WrongState),
)
async def replay_render(render_id: str, request: Request, operations: Service) -> Render:
    """A new render with the samples per tile that this one has now: its image has the same bits."""
    body = await read_json(request, ReplayRenderRequest, SMALL_BODY_BYTES)
    return await operations.renders.replay(render_id, body.request_id)


@router.get("/renders/{render_id}/baselines", responses=_OF_ONE)
async def get_baselines(render_id: str, operations: Service) -> Baselines:
    """Renders of the same scene and film by other versions of the tracing engine, to be compared with."""
    return await operations.renders.baselines(render_id)


@router.get("/renders/{render_id}/explanation", responses=_OF_ONE)
async def explain_render(render_id: str, operations: Service) -> Explanation:
    """What the render waits for, in one sentence."""
    return await operations.renders.explain(render_id)


@router.get("/renders/{render_id}/tiles-in-progress", responses=_OF_ONE)
async def get_tiles_in_progress(render_id: str, operations: Service) -> TilesInProgress:
    """Which tiles are being traced, and by whom."""
    return await operations.renders.tiles_in_progress(render_id)


@router.get("/renders/{render_id}/convergence", responses=_OF_ONE)
async def get_convergence(render_id: str, operations: Service) -> Convergence:
    """The error estimate at every preview so far."""
    return await operations.renders.convergence(render_id)


@router.post(
    "/groups",
    status_code=201,
    openapi_extra=body_of(CreateGroupRequest),
    responses=_OF_NEW,
)
async def create_group(request: Request, operations: Service) -> NewGroup:
    """Submits a scene as many renders, frames and variants. Repeating a request_id gives back the same."""
    body = await read_json(request, CreateGroupRequest, CREATE_BODY_BYTES)
    return await operations.renders.create_group(body)


@router.get("/groups/{name}", responses=errors(NotFound))
async def get_group(name: str, operations: Service) -> Group:
    """Renders that were submitted together, as one; `GET /v1/renders?group=NAME` lists them."""
    return await operations.groups.get(name)


@router.post("/renders/{render_id}:cancel", openapi_extra=_ACTION, responses=_OF_ONE)
async def cancel_render(render_id: str, request: Request, operations: Service) -> Render:
    """Stops a render; merged samples stay and can be fetched. Changes nothing on an ended render."""
    body = await _action(request)
    return await operations.controls.cancel(render_id, body.request_id)


@router.post("/renders/{render_id}:pause", openapi_extra=_ACTION, responses=_OF_ONE_IN_A_STATE)
async def pause_render(render_id: str, request: Request, operations: Service) -> Render:
    """Stops work on a render until it is resumed; merged samples stay."""
    await _action(request)
    return await operations.controls.pause(render_id)


@router.post("/renders/{render_id}:resume", openapi_extra=_ACTION, responses=_OF_ONE_IN_A_STATE)
async def resume_render(render_id: str, request: Request, operations: Service) -> Render:
    """Goes on with a paused render; with a degraded one, by tracing its failed tiles again."""
    await _action(request)
    return await operations.controls.resume(render_id)


@router.post(
    "/renders/{render_id}:extend",
    openapi_extra=body_of(ExtendRenderRequest),
    responses=errors(NotFound, AmbiguousId, WrongState, QuotaUsedUp),
)
async def extend_render(render_id: str, request: Request, operations: Service) -> Render:
    """More samples or other conditions, also after the end; all others stay as they are."""
    body = await read_json(request, ExtendRenderRequest, SMALL_BODY_BYTES)
    return await operations.controls.extend(render_id, body.samples, body.stop, body.drop)


@router.post("/renders/{render_id}:setPriority", openapi_extra=body_of(SetPriorityRequest), responses=_OF_ONE)
async def set_priority(render_id: str, request: Request, operations: Service) -> Render:
    """The render's weight among those of its owner."""
    body = await read_json(request, SetPriorityRequest, SMALL_BODY_BYTES)
    return await operations.controls.set_priority(render_id, body.priority)


@router.post("/renders/{render_id}:setTags", openapi_extra=body_of(SetTagsRequest), responses=_OF_ONE)
async def set_tags(render_id: str, request: Request, operations: Service) -> Render:
    """Words to sort renders by, instead of those that it has."""
    body = await read_json(request, SetTagsRequest, SMALL_BODY_BYTES)
    return await operations.controls.set_tags(render_id, body.tags)


@router.post("/renders/{render_id}:lookFirst", openapi_extra=body_of(LookFirstRequest), responses=_OF_ONE)
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
