"""Assets: files by content."""

from fastapi import APIRouter, Request
from nocturne_coordinator.errors import QuotaUsedUp
from nocturne_scene.errors import InputError, NotFound
from starlette.responses import Response

from nocturne_api.errors import FolderFull, Overloaded
from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.models.assets import Asset, BatchMissingRequest, BatchMissingResponse
from nocturne_api.rest.contract import body_of, errors
from nocturne_api.rest.requests import Service, declared_bytes, pieces, read_json

router = APIRouter(prefix="/v1", tags=["assets"])

_FILE = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}


@router.post("/assets:batchMissing", openapi_extra=body_of(BatchMissingRequest))
async def missing_assets(request: Request, operations: Service) -> BatchMissingResponse:
    """Which of these files the service does not have yet."""
    body = await read_json(request, BatchMissingRequest, SMALL_BODY_BYTES)
    return await operations.assets.missing(body.sha256)


@router.put(
    "/assets/{sha256}",
    openapi_extra={"requestBody": {"required": True, "content": _FILE}},
    responses=errors(QuotaUsedUp, FolderFull, Overloaded),
)
async def store_asset(sha256: str, request: Request, operations: Service) -> Asset:
    """Stores a file; its bytes must have this digest and the declared length. Uploading again is harmless."""
    size_bytes = declared_bytes(request)
    if size_bytes < 0:
        raise InputError.at("Content-Length", "the size of the file must be declared")
    return await operations.assets.store(sha256, size_bytes, pieces(request))


@router.head("/assets/{sha256}", response_class=Response, responses=errors(NotFound))
async def asset_size(sha256: str, operations: Service) -> Response:
    """Whether a file is stored; Content-Length is its size."""
    asset = await operations.assets.get(sha256)
    return Response(headers={"Content-Length": str(asset.size_bytes), "ETag": f'"{sha256}"'})
