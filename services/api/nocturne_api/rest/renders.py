"""Renders: create, list, read, delete, replay, and how the error falls."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.errors import AmbiguousId, Conflict, QuotaUsedUp, WrongState
from nocturne_scene.errors import NotFound
from starlette.responses import Response

from nocturne_api.errors import FolderFull, Overloaded
from nocturne_api.limits import CREATE_BODY_BYTES, SMALL_BODY_BYTES
from nocturne_api.models.renders import (
    Baselines,
    Convergence,
    CreateRenderRequest,
    Explanation,
    Render,
    RenderPage,
    ReplayRenderRequest,
    TilesInProgress,
)
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.contract import body_of, errors

router = APIRouter(prefix="/v1/renders", tags=["renders"])

_OF_ONE = errors(NotFound, AmbiguousId)


@router.post(
    "",
    status_code=201,
    openapi_extra=body_of(CreateRenderRequest),
    responses=errors(Conflict, QuotaUsedUp, FolderFull, Overloaded),
)
async def create_render(request: Request, operations: Service) -> Render:
    """Submits a scene. Repeating a request_id gives back the render made before."""
    return await operations.renders.create(await read_json(request, CreateRenderRequest, CREATE_BODY_BYTES))


@router.get("")
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


@router.get("/{render_id}", responses=_OF_ONE)
async def get_render(render_id: str, operations: Service) -> Render:
    """One render, by its id or the beginning of it."""
    return await operations.renders.get(render_id)


@router.delete(
    "/{render_id}", status_code=204, response_class=Response, responses=errors(NotFound, WrongState)
)
async def delete_render(render_id: str, operations: Service) -> Response:
    """Forgets a render that has ended, with its images and the files that no other render uses."""
    await operations.renders.delete(render_id)
    return Response(status_code=204)


@router.post(
    "/{render_id}:replay",
    status_code=201,
    openapi_extra=body_of(ReplayRenderRequest),
    responses=errors(NotFound, AmbiguousId, Conflict, QuotaUsedUp, FolderFull, WrongState),
)
async def replay_render(render_id: str, request: Request, operations: Service) -> Render:
    """A new render with the samples per tile that this one has now: its image has the same bits."""
    body = await read_json(request, ReplayRenderRequest, SMALL_BODY_BYTES)
    return await operations.renders.replay(render_id, body.request_id)


@router.get("/{render_id}/baselines", responses=_OF_ONE)
async def get_baselines(render_id: str, operations: Service) -> Baselines:
    """Renders of the same scene and film by other versions of the tracing engine, to be compared with."""
    return await operations.renders.baselines(render_id)


@router.get("/{render_id}/explanation", responses=_OF_ONE)
async def explain_render(render_id: str, operations: Service) -> Explanation:
    """What the render waits for, in one sentence."""
    return await operations.renders.explain(render_id)


@router.get("/{render_id}/tiles-in-progress", responses=_OF_ONE)
async def get_tiles_in_progress(render_id: str, operations: Service) -> TilesInProgress:
    """Which tiles are being traced, and by whom."""
    return await operations.renders.tiles_in_progress(render_id)


@router.get("/{render_id}/convergence", responses=_OF_ONE)
async def get_convergence(render_id: str, operations: Service) -> Convergence:
    """The error estimate at every preview so far."""
    return await operations.renders.convergence(render_id)
