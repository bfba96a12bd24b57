"""Photometry of images: regions, lines, histograms, isolines and glare."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.errors import AmbiguousId
from nocturne_scene.errors import NotFound
from nocturne_scene.photometry.glare import DEFAULT_THRESHOLD, View
from starlette.responses import Response

from nocturne_api.limits import SMALL_BODY_BYTES
from nocturne_api.models.measurements import (
    Glare,
    Isolines,
    KeepRegionsRequest,
    MeasuredRegions,
    Measurements,
    MeasureRequest,
)
from nocturne_api.operations.annual import YearQuestion
from nocturne_api.operations.reports import ReportQuestion
from nocturne_api.rest.contract import answers, body_of, errors
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


_YEAR = {**answers("application/json", "The year, as `nocturne annual` writes it."), **_OF_ONE}


@router.get("/{render_id}/annual.json", response_class=Response, responses=_YEAR)
async def get_annual(
    render_id: str,
    operations: Service,
    lux: Annotated[float, Query(description="Illuminance that counts as enough, lx.")] = 300.0,
    first_hour: Annotated[float, Query(description="Of the day, from which light counts.")] = 8.0,
    last_hour: Annotated[float, Query(description="Until which it counts.")] = 18.0,
    eye: Annotated[list[str] | None, Query(description="Instruments at eyes: simplified DGP.")] = None,
    ground: Annotated[float, Query(description="Reflectance of the ground beyond the scene.")] = 0.2,
) -> Response:
    """A year of daylight, of the group that a render of daylight coefficients is in: sDA, ASE, autonomy.

    404 where the group lacks one of the renders that a year takes, or where one has not ended.
    """
    asked = YearQuestion(lux, (first_hour, last_hour), tuple(eye or ()), ground)
    content = await operations.annual.year(render_id, asked)
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="application/json")


_PDF = {**answers("application/pdf", "The report."), **_OF_ONE}
_WORDS = {**answers("application/json", "What the report says."), **_OF_ONE}
_HTML = {**answers("text/html", "The report, one file."), **_OF_ONE}
# It has its styles inside, and nothing else.
_OF_HTML = {"Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; img-src data:"}

Require = Annotated[
    str, Query(description="Such as `EN 12464-1:34.2`, or `Em=500,U0=0.6`; empty: nothing is judged.")
]
Task = Annotated[str, Query(description="The instrument that it is for; empty: the first grid of a plane.")]
Title = Annotated[str, Query(description="Empty: the render's name.")]


@router.get("/{render_id}/report.pdf", response_class=Response, responses=_PDF)
async def get_report_pdf(
    render_id: str, operations: Service, require: Require = "", task: Task = "", title: Title = ""
) -> Response:
    """The report of `nocturne report` on a render of illuminance: plans, tables, whether a requirement holds.

    Panoramas of the render's group are rated for glare; a year of daylight in it is told.
    """
    content = await operations.reports.make(render_id, "pdf", ReportQuestion(require, task, title))
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="application/pdf")


@router.get("/{render_id}/report.json", response_class=Response, responses=_WORDS)
async def get_report_words(
    render_id: str, operations: Service, require: Require = "", task: Task = "", title: Title = ""
) -> Response:
    """The same without its drawings: verdict, each limit, tables of text."""
    content = await operations.reports.make(render_id, "json", ReportQuestion(require, task, title))
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="application/json")


@router.get("/{render_id}/report.html", response_class=Response, responses=_HTML)
async def get_report_html(
    render_id: str, operations: Service, require: Require = "", task: Task = "", title: Title = ""
) -> Response:
    """The same as a page."""
    content = await operations.reports.make(render_id, "html", ReportQuestion(require, task, title))
    headers = {"Cache-Control": "no-cache", **_OF_HTML}
    return Response(content, headers=headers, media_type="text/html; charset=utf-8")


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
