"""Preflights: what scenes need for a target error."""

from fastapi import APIRouter, Request

from nocturne_api.errors import CantPreflight, Overloaded
from nocturne_api.limits import CREATE_BODY_BYTES
from nocturne_api.models.preflights import PreflightReport, PreflightRequest
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.contract import body_of, errors

router = APIRouter(prefix="/v1/preflights", tags=["preflights"])


@router.post("", openapi_extra=body_of(PreflightRequest), responses=errors(CantPreflight, Overloaded))
async def preflight(request: Request, operations: Service) -> PreflightReport:
    """What each part of a scene changes and costs, and the document that is enough. Takes minutes."""
    return await operations.preflights.run(await read_json(request, PreflightRequest, CREATE_BODY_BYTES))
