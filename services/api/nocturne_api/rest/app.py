"""Puts the REST endpoint together. `python -m nocturne_api.rest.app` prints its OpenAPI document."""

import json
import sys
from pathlib import Path

from fastapi import FastAPI
from fastapi.routing import APIRoute
from starlette.types import ASGIApp

from nocturne_api.access import Authenticator
from nocturne_api.operations.operations import Operations
from nocturne_api.rest import (
    assets,
    events,
    health,
    images,
    measurements,
    page,
    pictures,
    problems,
    renders,
    scenes,
    session,
    webhooks,
    workers,
)
from nocturne_api.rest.contract import DescribedApp, errors
from nocturne_api.rest.middleware import SecurityMiddleware
from nocturne_api.rest.protocol import LeavingMiddleware, LingeringMiddleware

_ROUTERS = (
    renders,
    scenes,
    images,
    measurements,
    pictures,
    events,
    session,
    assets,
    workers,
    webhooks,
    health,
    page,
)


def described_app() -> FastAPI:
    """All routes with their descriptions, over no operations yet."""
    app = DescribedApp(
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=_name_of,
    )
    problems.install(app)
    for module in _ROUTERS:
        # Probes ask without a token, and never in vain.
        app.include_router(module.router, responses={} if module is health else errors())
    return app


def build_rest(operations: Operations, web: Path, loopback_only: bool, authenticate: bool = False) -> ASGIApp:
    """The ASGI application over `operations`, with the page in the folder `web` at `/`."""
    app = described_app()
    app.state.operations = operations
    app.state.page = app.router.default = page.Page(web)
    authenticator = Authenticator(operations.identify, operations.identify_session) if authenticate else None
    guarded = SecurityMiddleware(app, loopback_only, authenticator, operations.check_folder)
    return LingeringMiddleware(LeavingMiddleware(guarded))


def _name_of(route: APIRoute) -> str:
    return route.name


def main() -> None:
    """Prints the document as docs/reference/openapi.json has it."""
    json.dump(described_app().openapi(), sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")


if __name__ == "__main__":
    main()
