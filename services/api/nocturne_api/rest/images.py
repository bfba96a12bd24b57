"""Previews and images, with ETags, whole or in parts."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.errors import AmbiguousId
from nocturne_scene.errors import NotFound
from starlette.responses import Response, StreamingResponse

from nocturne_api.children.denoising import DIFFERENCE, EXR, PNG
from nocturne_api.files.byte_range import asked_range
from nocturne_api.files.open_file import OpenFile
from nocturne_api.files.tiles import MEDIA_TYPE, Cursor
from nocturne_api.models.measurements import LearnedLight, Reading
from nocturne_api.rest.contract import answers, errors
from nocturne_api.rest.requests import Service

router = APIRouter(prefix="/v1/renders", tags=["images"])

_OF_ONE = errors(NotFound, AmbiguousId)
_PNG = {**answers("image/png", "The picture.", conditional=True), **_OF_ONE}
_EXR = {**answers("image/x-exr", "The image.", conditional=True), **_OF_ONE}
_SCENE = {**answers("application/json", "The document."), **_OF_ONE}
_LOG = {**answers("text/plain", "Lines, oldest first."), **_OF_ONE}
_BUNDLE = {**answers("application/zip", "The ZIP."), **_OF_ONE}
_TILES = {
    **answers(MEDIA_TYPE, "The tiles, little-endian (docs/reference/api.md).", conditional=True),
    **_OF_ONE,
}


@router.head("/{render_id}/preview.png", include_in_schema=False)
@router.get("/{render_id}/preview.png", response_class=Response, responses=_PNG)
async def get_preview(render_id: str, request: Request, operations: Service) -> Response:
    """The tone-mapped PNG of the samples merged by now."""
    return _answer(request, await operations.images.open_preview(render_id), "image/png")


@router.head("/{render_id}/thumbnail.png", include_in_schema=False)
@router.get("/{render_id}/thumbnail.png", response_class=Response, responses=_PNG)
async def get_thumbnail(render_id: str, request: Request, operations: Service) -> Response:
    """The preview in small, for lists."""
    return _answer(request, await operations.images.open_thumbnail(render_id), "image/png")


@router.get("/{render_id}/tiles", response_class=Response, responses=_TILES)
async def get_tiles(
    render_id: str,
    request: Request,
    operations: Service,
    since: Annotated[str, Query(description="ETag of the answer before, without its quotes.")] = "",
) -> Response:
    """Tiles whose samples changed since an earlier answer, as floats; about 4 MiB at once.

    The layout is in docs/reference/api.md. 304 where If-None-Match is `since` and nothing changed.
    """
    found = await operations.images.tiles(render_id, Cursor.of(since))
    headers = {"ETag": f'"{found.end}"', "Cache-Control": "no-store"}
    if str(found.end) == since and _is_known(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return Response(found.content, headers=headers, media_type=MEDIA_TYPE)


@router.get("/{render_id}/reading", responses=_OF_ONE)
async def read_region(
    render_id: str,
    operations: Service,
    x: Annotated[int, Query(description="Pixels from the left.")] = 0,
    y: Annotated[int, Query(description="Pixels from the top.")] = 0,
    width: Annotated[int, Query(description="Pixels; with a height of 0 as well, the whole film.")] = 0,
    height: Annotated[int, Query(description="Pixels.")] = 0,
) -> Reading:
    """What a region of the image shows, in numbers, with their errors."""
    region = Region(x, y, width, height) if width or height else None
    return await operations.readings.read(render_id, region)


@router.get("/{render_id}/learned-light", responses=_OF_ONE)
async def get_learned_light(
    render_id: str,
    operations: Service,
    x: Annotated[int, Query(description="Pixels from the left.")] = 0,
    y: Annotated[int, Query(description="Pixels from the top.")] = 0,
) -> LearnedLight:
    """Where light comes from by mirrors and glass at what a pixel shows, as a pilot learned it.

    404 for a render whose photons are not guided.
    """
    return await operations.learned_lights.at(render_id, x, y)


@router.head("/{render_id}/image.exr", include_in_schema=False)
@router.get("/{render_id}/image.exr", response_class=Response, responses=_EXR)
async def get_image(render_id: str, request: Request, operations: Service) -> Response:
    """EXR: all quantities, their errors, n; of the samples committed by now, and final after the end."""
    return _answer(request, await operations.images.open_exr(render_id), "image/x-exr")


@router.head("/{render_id}/denoised.exr", include_in_schema=False)
@router.get("/{render_id}/denoised.exr", response_class=Response, responses=_EXR)
async def get_denoised_exr(render_id: str, request: Request, operations: Service) -> Response:
    """EXR of a denoised picture of the image as it is now, to look at: its values are no measurement.

    Layers `denoised`, linear sRGB, and `difference`, from the true image in error bars. 404 where the service
    has no denoiser.
    """
    return _answer(request, await operations.denoised.open(render_id, EXR), "image/x-exr")


@router.head("/{render_id}/denoised.png", include_in_schema=False)
@router.get("/{render_id}/denoised.png", response_class=Response, responses=_PNG)
async def get_denoised_png(render_id: str, request: Request, operations: Service) -> Response:
    """The denoised picture, tone-mapped."""
    return _answer(request, await operations.denoised.open(render_id, PNG), "image/png")


@router.head("/{render_id}/difference.png", include_in_schema=False)
@router.get("/{render_id}/difference.png", response_class=Response, responses=_PNG)
async def get_difference_png(render_id: str, request: Request, operations: Service) -> Response:
    """Where the denoised picture leaves the true image: dark within its error bar, then blue, yellow from two
    bars and red from three."""
    return _answer(request, await operations.denoised.open(render_id, DIFFERENCE), "image/png")


@router.get("/{render_id}/scene.json", response_class=Response, responses=_SCENE)
async def get_scene(render_id: str, operations: Service) -> Response:
    """The scene document as it was submitted; its files are named by SHA-256."""
    content = await operations.images.open_scene(render_id)
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="application/json")


@router.get("/{render_id}/log.txt", response_class=Response, responses=_LOG)
async def get_log(render_id: str, operations: Service) -> Response:
    """What happened to the render: calls, how its error fell, tiles that failed, its end."""
    content = await operations.bundles.log(render_id)
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="text/plain; charset=utf-8")


@router.get("/{render_id}/bundle.zip", response_class=Response, responses=_BUNDLE)
async def get_bundle(render_id: str, operations: Service) -> Response:
    """What somebody needs who is asked about it: state, log, scene document, schedule, failures of tiles."""
    content = await operations.bundles.bundle(render_id)
    return Response(content, headers={"Cache-Control": "no-cache"}, media_type="application/zip")


def _answer(request: Request, opened: OpenFile, media_type: str) -> Response:
    """The file or a part of it, or nothing where it is known or only its head is wanted."""
    # no-cache lets a browser keep the image, but ask before every use.
    headers = {"ETag": opened.etag, "Cache-Control": "no-cache", "Accept-Ranges": "bytes"}
    size, asked = opened.size_bytes, request.headers
    part, status = None, 200
    # The rest of another file is no rest of this one.
    if asked.get("if-range", opened.etag) == opened.etag:
        part = asked_range(asked.get("range", ""), size)
    if _is_known(asked.get("if-none-match", ""), opened.etag):
        status = 304
    elif part is not None:
        status = 206 if part else 416
        headers["Content-Range"] = f"bytes {part.start}-{part.stop - 1}/{size}" if part else f"bytes */{size}"
    if status in (200, 206):
        headers["Content-Length"] = str(size if part is None else len(part))
        if request.method != "HEAD":
            return StreamingResponse(opened.chunks(part), status, headers, media_type)
    opened.close()
    return Response(None, status, headers, media_type)


def _is_known(if_none_match: str, etag: str) -> bool:
    tags = [tag.strip().removeprefix("W/") for tag in if_none_match.split(",")]
    return etag in tags or "*" in tags
