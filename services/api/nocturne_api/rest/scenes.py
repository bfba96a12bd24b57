"""Imports of other renderers' scenes, and preflights, which say what a scene needs."""

from fastapi import APIRouter, Request
from nocturne_coordinator.errors import QuotaUsedUp

from nocturne_api.errors import FolderFull, Overloaded, PreflightFailed
from nocturne_api.limits import CREATE_BODY_BYTES
from nocturne_api.models.scenes import ImportedScene, ImportRequest, PreflightReport, PreflightRequest
from nocturne_api.rest.contract import body_of, errors
from nocturne_api.rest.requests import Service, read_json

router = APIRouter(prefix="/v1")


@router.post(
    "/preflights",
    tags=["preflights"],
    openapi_extra=body_of(PreflightRequest),
    responses=errors(PreflightFailed, Overloaded),
)
async def preflight(request: Request, operations: Service) -> PreflightReport:
    """What each part of a scene changes and costs, and the document that is enough. Takes minutes."""
    return await operations.preflights.run(await read_json(request, PreflightRequest, CREATE_BODY_BYTES))


@router.post(
    "/imports",
    tags=["imports"],
    openapi_extra=body_of(ImportRequest),
    responses=errors(Overloaded, QuotaUsedUp, FolderFull),
)
async def import_scene(request: Request, operations: Service) -> ImportedScene:
    """The scene document of another renderer's scene, whose files were uploaded. Takes up to minutes."""
    body = await read_json(request, ImportRequest, CREATE_BODY_BYTES)
    return await operations.imports.run(body)
