"""Figures for Prometheus."""

from fastapi import APIRouter
from starlette.responses import PlainTextResponse, Response

from nocturne_api.rest.access import Service

router = APIRouter(tags=["health"])


@router.get("/metrics", response_class=PlainTextResponse)
async def metrics(operations: Service) -> Response:
    """Counts and states in the text format of Prometheus."""
    return Response(await operations.health.metrics(), media_type="text/plain; version=0.0.4; charset=utf-8")
