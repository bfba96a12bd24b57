"""Photometry of images: regions, lines, histograms, isolines and glare."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.errors import AmbiguousId
from nocturne_scene.errors import NotFound
from nocturne_scene.photometry.glare import DEFAULT_THRESHOLD, View

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.models.measurements import (
    Glare,
    Isolines,
    KeepRegionsRequest,
    MeasuredRegions,
    Measurements,
    MeasureRequest,
)
from nocturne_api.rest.contract import body_of, errors
from nocturne_api.rest.requests import Service, read_json

router = APIRouter(prefix="/v1/renders", tags=["measurements"])

_OF_ONE = errors(NotFound, AmbiguousId)


@router.post("/{render_id}:measure", openapi_extra=body_of(MeasureRequest), responses=_OF_ONE)
async def measure(render_id: str, request: Request, operations: Service) -> Measurements:
    """Extremes, mean and uniformity of parts of the image, with errors; profiles, histograms."""
    body = await read_json(request, MeasureRequest, SMALL_BODY_BYTES)
    return await operations.measurements.measure(render_id, body)


@router.get("/{render_id}/regions", responses=_OF_ONE)
async def get_regions(render_id: str, operations: Service) -> MeasuredRegions:
    """Parts of the film that are kept with the render to be measured."""
    return await operations.measurements.regions(render_id)


@router.put("/{render_id}/regions", openapi_extra=body_of(KeepRegionsRequest), responses=_OF_ONE)
async def keep_regions(render_id: str, request: Request, operations: Service) -> MeasuredRegions:
    """Keeps these parts of the film with the render, instead of all that were kept."""
    body = await read_json(request, KeepRegionsRequest, SMALL_BODY_BYTES)
    return await operations.measurements.keep_regions(render_id, body.regions)


@router.get("/{render_id}/isolines", responses=_OF_ONE)
async def get_isolines(
    render_id: str,
    operations: Service,
    level: Annotated[list[float] | None, Query(description="At most 32; without any, round numbers.")] = None,
    channel: Annotated[str, Query(description="X, Y, Z, or a further response of the sensor.")] = "Y",
) -> Isolines:
    """Lines along which the image has these values, of means over blocks of pixels."""
    return await operations.measurements.isolines(render_id, level or [], channel)


@router.get("/{render_id}/glare", responses=_OF_ONE)
async def get_glare(
    render_id: str,
    operations: Service,
    azimuth: Annotated[float, Query(description="Degrees to the right of the panorama's middle.")] = 0.0,
    elevation: Annotated[float, Query(description="Degrees above the horizon.")] = 0.0,
    threshold: Annotated[
        float | None,
        Query(
            description="cd/m2 from which a pixel is part of a source. Without it, UGR's sources are the "
            f"luminaires in sight, and DGP's pixels of {DEFAULT_THRESHOLD:g} cd/m2 and more."
        ),
    ] = None,
) -> Glare:
    """Unified glare rating and daylight glare probability of an eye that looks at a panorama."""
    return await operations.measurements.glare(render_id, View(azimuth, elevation, threshold))
