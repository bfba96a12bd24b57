"""What routes take of requests: the operations, and bodies within bounds.

A body that is too big is not read to the end, declared or not.
"""

import asyncio
import logging
from collections.abc import AsyncIterator
from typing import Annotated, TypeVar

from fastapi import Depends, Request
from nocturne_scene.document.json_text import decode_json
from nocturne_scene.errors import InputError
from starlette.requests import ClientDisconnect

from nocturne_api.errors import ClientDisconnected
from nocturne_api.models.base import RequestBody, validated
from nocturne_api.operations.operations import Operations

_log = logging.getLogger(__name__)

_Model = TypeVar("_Model", bound=RequestBody)


def _operations(request: Request) -> Operations:
    operations: Operations = request.app.state.operations
    return operations


Service = Annotated[Operations, Depends(_operations)]


async def read_json(request: Request, model: type[_Model], limit_bytes: int) -> _Model:
    """The body as `model`; InputError for a body that is too big, no JSON, too deep, or not of the model's
    form."""
    return validated(model, await asyncio.to_thread(decode_json, await _read(request, limit_bytes)))


async def pieces(request: Request) -> AsyncIterator[bytes]:
    """The body as it comes; ClientDisconnected where the caller goes away before its end."""
    try:
        async for piece in request.stream():
            yield piece
    except ClientDisconnect:
        _log.info("a request to %s was broken off by its caller", request.url.path[:100])
        raise ClientDisconnected("the caller went away before the end of the request") from None


async def _read(request: Request, limit_bytes: int) -> bytes:
    too_big = InputError.at(
        "$", f"the request body has more than {limit_bytes} bytes; put large meshes into assets"
    )
    if declared_bytes(request) > limit_bytes:
        raise too_big
    body = bytearray()
    async for piece in pieces(request):
        body += piece
        if len(body) > limit_bytes:
            raise too_big
    return bytes(body)


def declared_bytes(request: Request) -> int:
    """The body's length as its sender declared it, -1 where it did not."""
    text = request.headers.get("content-length", "")
    return int(text) if text.isdecimal() else -1
