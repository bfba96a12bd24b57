"""Image files from elsewhere, which the page compares with a render."""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from nocturne_scene.errors import InputError
from starlette.responses import Response, StreamingResponse

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.children.pools import picture_as_tiles
from nocturne_api.errors import Overloaded, RateLimited, RequestTimedOut
from nocturne_api.files.tiles import MEDIA_TYPE
from nocturne_api.limits import CHUNK_BYTES, PICTURE_BYTES
from nocturne_api.places import to_the_end
from nocturne_api.rest.contract import answers, errors
from nocturne_api.rest.requests import declared_bytes, pieces

router = APIRouter(prefix="/v1/pictures", tags=["images"])

_on_their_way: Counter[str] = Counter()
"""By owner."""

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
        with _coming():
            await _receive(request, folder / "picture.exr")
        await picture_as_tiles(folder / "picture.exr", folder / "tiles", tile_size)
        size = (folder / "tiles").stat().st_size
        # The folder goes when the answer is sent, or its reader has left.
        pieces_of = _pieces(folder / "tiles", cleaning.pop_all())
    return StreamingResponse(
        pieces_of,
        headers={"Content-Length": str(size), "Cache-Control": "no-store"},
        media_type=MEDIA_TYPE,
    )


async def _receive(request: Request, file: Path) -> None:
    too_big = InputError.at("$", f"the picture has more than {PICTURE_BYTES} bytes")
    if declared_bytes(request) > PICTURE_BYTES:
        raise too_big
    received = 0
    try:
        async with asyncio.timeout(limits.PICTURE_COMES_S):
            with file.open("wb") as out:
                async for piece in pieces(request):
                    received += len(piece)
                    if received > PICTURE_BYTES:
                        raise too_big
                    await to_the_end(out.write, piece)
    except TimeoutError:
        raise RequestTimedOut(f"the picture did not come within {limits.PICTURE_COMES_S:g} s") from None


@contextmanager
def _coming() -> Iterator[None]:
    """Bounds how many are being received, before their first byte. Raises Overloaded, RateLimited."""
    owner = CALLER.get().name
    if _on_their_way.total() >= limits.PICTURES_COMING:
        raise Overloaded(f"{limits.PICTURES_COMING} pictures are being sent; try again.")
    if owner and _on_their_way[owner] >= limits.PICTURES_OF_OWNER:
        raise RateLimited(f"{_on_their_way[owner]} pictures of {owner} are being sent; send fewer at once")
    _on_their_way[owner] += 1
    try:
        yield
    finally:
        _on_their_way[owner] -= 1


async def _pieces(file: Path, cleaning: ExitStack) -> AsyncIterator[bytes]:
    with cleaning, file.open("rb") as opened:
        while piece := await to_the_end(opened.read, CHUNK_BYTES):
            yield piece
