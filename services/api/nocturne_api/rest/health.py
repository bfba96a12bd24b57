"""Health, for orchestrators and Prometheus."""

from typing import Annotated, Any

from fastapi import APIRouter, Query
from starlette.responses import JSONResponse, PlainTextResponse, Response

from nocturne_api.models.health import CheckName, Readiness
from nocturne_api.rest.contract import errors, reference_to
from nocturne_api.rest.requests import Service

router = APIRouter(tags=["health"])

_NOT_READY: dict[int | str, dict[str, Any]] = {
    **errors(),
    503: {
        "description": "Some check failed.",
        "content": {"application/json": {"schema": reference_to(Readiness)}},
    },
}
_EXCLUDE = Query(description="Checks that do not count, and are left out of the answer.")


@router.get("/healthz", response_class=PlainTextResponse)
async def alive() -> str:
    """The process answers."""
    return "alive\n"


@router.get("/readyz", response_model=Readiness, responses=_NOT_READY)
async def ready(operations: Service, exclude: Annotated[list[CheckName] | None, _EXCLUDE] = None) -> Response:
    """The service reads, writes, takes renders, and merges results; else 503, with what fails. The answer may
    be a second old."""
    found = await operations.readiness.look(exclude or ())
    headers = {} if found.ready else {"Retry-After": "5"}
    return JSONResponse(found.model_dump(), 200 if found.ready else 503, headers)


@router.get("/metrics", response_class=PlainTextResponse, responses=errors())
async def metrics(operations: Service) -> Response:
    """Counts and states in the text format of Prometheus."""
    return Response(await operations.health.metrics(), media_type="text/plain; version=0.0.4; charset=utf-8")
