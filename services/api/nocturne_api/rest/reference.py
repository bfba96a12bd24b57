"""The API reference at /docs: Swagger UI, built with the page and served from here, on /openapi.json."""

from typing import Any

from fastapi import APIRouter, Request
from nocturne_scene.document.reference import json_schema
from starlette.responses import Response

router = APIRouter(include_in_schema=False)


@router.get("/docs")
async def reference(request: Request) -> Response:
    """The reference viewer; it loads nothing from elsewhere."""
    response: Response = request.app.state.page.file("reference.html")
    return response


@router.get("/scene.schema.json")
async def scene_schema() -> dict[str, Any]:
    """The JSON Schema of scene documents."""
    return json_schema()
