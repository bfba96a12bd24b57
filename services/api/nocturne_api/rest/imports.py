"""Imports: scenes of other renderers become scene documents."""

from fastapi import APIRouter, Request
from nocturne_coordinator.errors import QuotaUsedUp

from nocturne_api.errors import FolderFull, Overloaded
from nocturne_api.limits import CREATE_BODY_BYTES
from nocturne_api.models.imports import ImportedScene, ImportRequest
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.contract import body_of, errors

router = APIRouter(prefix="/v1/imports", tags=["imports"])


@router.post("", openapi_extra=body_of(ImportRequest), responses=errors(Overloaded, QuotaUsedUp, FolderFull))
async def import_scene(request: Request, operations: Service) -> ImportedScene:
    """The scene document of another renderer's scene, whose files were uploaded. Takes up to minutes."""
    body = await read_json(request, ImportRequest, CREATE_BODY_BYTES)
    return await operations.imports.run(body)
