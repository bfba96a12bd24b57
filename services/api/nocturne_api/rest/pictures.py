"""Image files from elsewhere, which the page compares with a render."""

import asyncio
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from nocturne_scene.errors import InputError
from starlette.background import BackgroundTask
from starlette.responses import Response, StreamingResponse

from nocturne_api.access import CALLER
from nocturne_api.children.pools import picture_as_tiles
from nocturne_api.errors import Overloaded
from nocturne_api.files.tiles import MEDIA_TYPE
from nocturne_api.limits import CHUNK_BYTES, PICTURE_BYTES
from nocturne_api.rest.contract import answers, errors
from nocturne_api.rest.requests import declared_bytes, pieces

router = APIRouter(prefix="/v1/pictures", tags=["images"])

_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"image/x-exr": {"schema": {"type": "string", "format": "binary"}}},
    }
}
_TILES = {
    **answers(MEDIA_TYPE, "The tiles, little-endian (docs/reference/api.md)."),
    **errors(InputError, Overloaded),
}


@router.post("", response_class=Response, openapi_extra=_BODY, responses=_TILES)
async def read_picture(
    request: Request,
    tile_size: Annotated[int, Query(ge=8, le=64, description="Edge of a tile, pixels.")] = 32,
) -> Response:
    """An OpenEXR file as tiles of floats, in the layout of a render's; nothing of it is kept.

    Channels X, Y, Z, or else R, G, B (linear sRGB), or Y; any compression, scan lines or tiles.
    """
    CALLER.get().need("read")
    with ExitStack() as cleaning:
        folder = Path(cleaning.enter_context(TemporaryDirectory(prefix="nocturne-picture-")))
        await _receive(request, folder / "picture.exr")
        await picture_as_tiles(folder / "picture.exr", folder / "tiles", tile_size)
        size = (folder / "tiles").stat().st_size
        # The folder goes when the answer is sent.
        gone = BackgroundTask(cleaning.pop_all().close)
    return StreamingResponse(
        _pieces(folder / "tiles"),
        headers={"Content-Length": str(size), "Cache-Control": "no-store"},
        media_type=MEDIA_TYPE,
        background=gone,
    )


async def _receive(request: Request, file: Path) -> None:
    too_big = InputError.at("$", f"the picture has more than {PICTURE_BYTES} bytes")
    if declared_bytes(request) > PICTURE_BYTES:
        raise too_big
    received = 0
    with file.open("wb") as out:
        async for piece in pieces(request):
            received += len(piece)
            if received > PICTURE_BYTES:
                raise too_big
            await asyncio.to_thread(out.write, piece)


def _pieces(file: Path) -> Iterator[bytes]:
    with file.open("rb") as opened:
        while piece := opened.read(CHUNK_BYTES):
            yield piece
