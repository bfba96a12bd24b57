"""What scenes need for a target error: preflights."""

from typing import Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field

from nocturne_api.limits import CREATE_BODY_BYTES, PREFLIGHT_BUDGET_S
from nocturne_api.preflight.pool import PreflightSpec
from nocturne_api.rest.access import Service
from nocturne_api.rest.bodies import read_json
from nocturne_api.rest.renders import body_of

router = APIRouter(prefix="/v1/preflights", tags=["preflights"])


class PreflightBody(BaseModel):
    """A scene, and the error that is wanted of its image."""

    model_config = ConfigDict(extra="forbid", strict=True)

    scene: dict[str, Any] = Field(description="The scene document; files that it names are uploaded.")
    width: int = Field(default=512, description="Film of the real render, pixels.")
    height: int = Field(default=512)
    error: float = Field(
        default=0.02, description="Total relative error, bias and noise together, in (0, 1)."
    )
    budget_seconds: float = Field(
        default=60.0,
        description=f"Processor time of the small renders, about; at most {PREFLIGHT_BUDGET_S:g}.",
    )


@router.post("", openapi_extra=body_of(PreflightBody))
async def preflight(request: Request, operations: Service) -> dict[str, Any]:
    """What each part of a scene changes and costs, and the document that is enough. Takes minutes."""
    body = await read_json(request, PreflightBody, CREATE_BODY_BYTES)
    return await operations.preflight(PreflightSpec(**dict(body)))
