"""Renders: create, get, list, all that can be done to one, and how the error falls."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.dispatch.region import Region
from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import Response

from nocturne_api.limits import CREATE_BODY_BYTES, SMALL_BODY_BYTES
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.submission import CreateRequest
from nocturne_api.views import AtWorkView, ConvergenceView, ExplanationView, PageView, RenderView

router = APIRouter(prefix="/v1/renders", tags=["renders"])


class CreateBody(BaseModel):
    """A scene to render."""

    model_config = ConfigDict(extra="forbid", strict=True)

    request_id: str = Field(description="Chosen by the client, 1 to 128 characters; makes retries safe.")
    name: str = ""
    scene: dict[str, Any] = Field(description="The scene document; assets referred to by `sha256:...`.")
    width: int = Field(description="Pixels.")
    height: int = Field(description="Pixels.")
    samples: int = Field(description="Samples per pixel, at most.")
    stop: dict[str, Any] = Field(
        default_factory=dict,
        description="What else ends it, whichever comes first: `relative_error`, `tile_relative_error`, "
        '`wall_seconds`, `cpu_seconds`, `until` ("07:00 Europe/Berlin", "2026-11-22T07:00:00Z").',
    )
    priority: int = Field(default=0, description="1 to 1000; 0 means 100.")


class ActBody(BaseModel):
    """Doing it twice is doing it once; the request id is kept for the log only."""

    model_config = ConfigDict(extra="forbid", strict=True)

    request_id: str = ""


class ExtendBody(ActBody):
    """More samples, or other conditions."""

    samples: int = Field(default=0, description="In all, at least as many as before; 0 means as many.")
    stop: dict[str, Any] = Field(default_factory=dict, description="Instead of those before.")


class PriorityBody(ActBody):
    """The render's weight among those of its owner."""

    priority: int = Field(description="1 to 1000.")


class LookFirstBody(ActBody):
    """A part of the film, in pixels from its upper left corner; width and height 0: all parts are alike."""

    x: int = 0
    y: int = 0
    width: int = 0
    height: int = 0


class ReplayBody(BaseModel):
    """A new render with the samples per tile that this one has now."""

    model_config = ConfigDict(extra="forbid", strict=True)

    request_id: str = Field(description="Chosen by the client, 1 to 128 characters; makes retries safe.")


def body_of(model: type[BaseModel], required: bool = True) -> dict[str, Any]:
    """The OpenAPI description of a body that is read within bounds by `read_json`."""
    schema = {"application/json": {"schema": model.model_json_schema()}}
    return {"requestBody": {"required": required, "content": schema}}


@router.post("", status_code=201, openapi_extra=body_of(CreateBody))
async def create_render(request: Request, operations: Service) -> RenderView:
    """Submits a scene. Repeating a request_id gives back the render made before."""
    body = await read_json(request, CreateBody, CREATE_BODY_BYTES)
    return await operations.create_render(CreateRequest(**dict(body)))


@router.get("")
async def list_renders(
    operations: Service,
    page_size: Annotated[int, Query(description="At most 200; 0 means 50.")] = 0,
    page_token: Annotated[str, Query(description="From the page before.")] = "",
) -> PageView:
    """One page of renders, newest first."""
    return await operations.list_renders(page_size, page_token)


@router.get("/{render_id}")
async def get_render(render_id: str, operations: Service) -> RenderView:
    """One render."""
    return await operations.get_render(render_id)


@router.post("/{render_id}:cancel", openapi_extra=body_of(ActBody, required=False))
async def cancel_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """Stops a render; what was merged stays and can be fetched. Changes nothing on an ended render."""
    body = await _act_body(request)
    return await operations.cancel_render(render_id, body.request_id)


@router.delete("/{render_id}", status_code=204, response_class=Response)
async def delete_render(render_id: str, operations: Service) -> Response:
    """Forgets a render that has ended, with its images and the files that no other render uses."""
    await operations.delete_render(render_id)
    return Response(status_code=204)


@router.post("/{render_id}:pause", openapi_extra=body_of(ActBody, required=False))
async def pause_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """No more work until it is resumed; what is merged stays."""
    await _act_body(request)
    return await operations.pause_render(render_id)


@router.post("/{render_id}:resume", openapi_extra=body_of(ActBody, required=False))
async def resume_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """Goes on with a paused render; with a degraded one, by tracing its failed tiles again."""
    await _act_body(request)
    return await operations.resume_render(render_id)


@router.post("/{render_id}:extend", openapi_extra=body_of(ExtendBody))
async def extend_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """More samples or other conditions, also after the end; nothing is traced again."""
    body = await read_json(request, ExtendBody, SMALL_BODY_BYTES)
    return await operations.extend_render(render_id, body.samples, body.stop)


@router.post("/{render_id}:setPriority", openapi_extra=body_of(PriorityBody))
async def set_priority(render_id: str, request: Request, operations: Service) -> RenderView:
    """The render's weight among those of its owner."""
    body = await read_json(request, PriorityBody, SMALL_BODY_BYTES)
    return await operations.set_priority(render_id, body.priority)


@router.post("/{render_id}:lookFirst", openapi_extra=body_of(LookFirstBody))
async def look_first(render_id: str, request: Request, operations: Service) -> RenderView:
    """Which part of the film gets its samples first; the finished image has the same bits with or without."""
    body = await read_json(request, LookFirstBody, SMALL_BODY_BYTES)
    region = Region(body.x, body.y, body.width, body.height)
    return await operations.look_first(render_id, region if region.width or region.height else None)


@router.post("/{render_id}:replay", status_code=201, openapi_extra=body_of(ReplayBody))
async def replay_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """A new render with the samples per tile that this one has now: its image has the same bits."""
    body = await read_json(request, ReplayBody, SMALL_BODY_BYTES)
    return await operations.replay_render(render_id, body.request_id)


@router.get("/{render_id}/explanation")
async def explain(render_id: str, operations: Service) -> ExplanationView:
    """What the render waits for, in one sentence."""
    return await operations.explain(render_id)


@router.get("/{render_id}/at-work")
async def at_work(render_id: str, operations: Service) -> AtWorkView:
    """Which tiles are being traced, and by whom."""
    return await operations.at_work(render_id)


@router.get("/{render_id}/convergence")
async def convergence(render_id: str, operations: Service) -> ConvergenceView:
    """The error estimate at every preview so far."""
    return await operations.convergence(render_id)


async def _act_body(request: Request) -> ActBody:
    """A body that may be left out."""
    has_body = request.headers.get("content-length", "0") != "0" or "transfer-encoding" in request.headers
    return await read_json(request, ActBody, SMALL_BODY_BYTES) if has_body else ActBody()
