"""Health, for orchestrators: is the process alive, and can it serve."""

from fastapi import APIRouter
from starlette.responses import PlainTextResponse

from nocturne_api.errors import Overloaded
from nocturne_api.rest.access import Service
from nocturne_api.rest.contract import errors

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
