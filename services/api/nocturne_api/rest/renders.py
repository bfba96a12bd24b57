"""Renders: create, get, list, cancel, and how the error falls."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, ConfigDict, Field

from nocturne_api.intake import CreateRequest
from nocturne_api.limits import CREATE_BODY_BYTES, SMALL_BODY_BYTES
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.views import ConvergenceView, PageView, RenderView

router = APIRouter(prefix="/v1/renders", tags=["renders"])


class CreateBody(BaseModel):
    """A scene to render."""

    model_config = ConfigDict(extra="forbid", strict=True)

    request_id: str = Field(description="Chosen by the client, 1 to 128 characters; makes retries safe.")
    name: str = ""
    scene: dict[str, Any] = Field(description="The scene document; assets referred to by `sha256:...`.")
    width: int = Field(description="Pixels.")
    height: int = Field(description="Pixels.")
    samples: int = Field(description="Samples per pixel.")


class CancelBody(BaseModel):
    """Cancelling twice is cancelling once; the request id is kept for the log only."""

    model_config = ConfigDict(extra="forbid", strict=True)

    request_id: str = ""


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


@router.post("/{render_id}:cancel", openapi_extra=body_of(CancelBody, required=False))
async def cancel_render(render_id: str, request: Request, operations: Service) -> RenderView:
    """Stops a render; what was merged stays and can be fetched. Changes nothing on an ended render."""
    has_body = request.headers.get("content-length", "0") != "0" or "transfer-encoding" in request.headers
    body = await read_json(request, CancelBody, SMALL_BODY_BYTES) if has_body else CancelBody()
    return await operations.cancel_render(render_id, body.request_id)


@router.get("/{render_id}/convergence")
async def convergence(render_id: str, operations: Service) -> ConvergenceView:
    """The error estimate at every preview so far."""
    return await operations.convergence(render_id)
