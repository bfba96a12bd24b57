"""Puts the REST door together."""

from pathlib import Path

from fastapi import FastAPI
from starlette.types import ASGIApp

from nocturne_api.operations import Operations
from nocturne_api.rest import (
    assets,
    events,
    health,
    images,
    metrics,
    preflights,
    problems,
    reference,
    renders,
    session,
    webhooks,
    workers,
)
from nocturne_api.rest.lingering import Lingering
from nocturne_api.rest.middleware import Guards
from nocturne_api.rest.page import Page

_ROUTERS = (
    renders,
    preflights,
    images,
    events,
    session,
    assets,
    workers,
    webhooks,
    health,
    metrics,
    reference,
)


def build_rest(operations: Operations, web: Path, loopback_only: bool, authenticate: bool = False) -> ASGIApp:
    """The ASGI application over `operations`, with the page in the folder `web` at `/`."""
    app = FastAPI(
        title="Nocturne",
        version="1",
        description="Renders scenes into spectral images in absolute units, with error bars.",
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        responses={
            "default": {"model": problems.ProblemDetails, "description": "Problem details, RFC 9457."}
        },
    )
    app.state.operations = operations
    problems.install(app)
    for module in _ROUTERS:
        app.include_router(module.router)
    app.router.default = Page(web)
    return Lingering(Guards(app, loopback_only, operations.identify if authenticate else None))
