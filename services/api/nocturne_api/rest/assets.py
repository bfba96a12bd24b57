"""Files by content."""

from fastapi import APIRouter, Request
from nocturne_scene.errors import InputError
from pydantic import BaseModel, ConfigDict
from starlette.responses import Response

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import declared_bytes, read_json
from nocturne_api.rest.renders import body_of
from nocturne_api.views import AssetView, DigestsView

router = APIRouter(prefix="/v1", tags=["assets"])


class DigestsBody(BaseModel):
    """SHA-256 digests, lower-case hexadecimal."""

    model_config = ConfigDict(extra="forbid", strict=True)

    sha256: list[str]


@router.post("/assets:batchMissing", openapi_extra=body_of(DigestsBody))
async def missing_assets(request: Request, operations: Service) -> DigestsView:
    """Which of these files the service does not have yet."""
    body = await read_json(request, DigestsBody, SMALL_BODY_BYTES)
    return DigestsView(sha256=await operations.missing_assets(body.sha256))


@router.put(
    "/assets/{sha256}",
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def store_asset(sha256: str, request: Request, operations: Service) -> AssetView:
    """Stores a file; its bytes must have this digest and the declared length. Uploading again is harmless."""
    size_bytes = declared_bytes(request)
    if size_bytes < 0:
        raise InputError.at("Content-Length", "the size of the file must be declared")
    return await operations.store_asset(sha256, size_bytes, request.stream())


@router.head("/assets/{sha256}", response_class=Response)
async def asset_size(sha256: str, operations: Service) -> Response:
    """Whether a file is stored; Content-Length is its size."""
    asset = await operations.asset(sha256)
    return Response(headers={"Content-Length": str(asset.size_bytes), "ETag": f'"{sha256}"'})
