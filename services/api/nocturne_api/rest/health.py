"""Health, for orchestrators and Prometheus."""

from fastapi import APIRouter
from starlette.responses import PlainTextResponse, Response

from nocturne_api.errors import Overloaded
from nocturne_api.rest.contract import errors
from nocturne_api.rest.requests import Service

router = APIRouter(tags=["health"])


@router.get("/healthz", response_class=PlainTextResponse)
async def alive() -> str:
    """The process answers."""
    return "alive\n"


@router.get("/readyz", response_class=PlainTextResponse, responses=errors(Overloaded))
async def ready(operations: Service) -> str:
    """The data folder answers too; else 503."""
    if not await operations.health.ready():
        raise Overloaded("The data folder does not answer.")
    return "ready\n"


@router.get("/metrics", response_class=PlainTextResponse, responses=errors())
async def metrics(operations: Service) -> Response:
    """Counts and states in the text format of Prometheus."""
    return Response(await operations.health.metrics(), media_type="text/plain; version=0.0.4; charset=utf-8")
