"""Answers that are given before the request has been read to its end."""

import asyncio
import time

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from nocturne_api.limits import LINGER_S


class LingeringMiddleware:
    """Reads on for a moment, and throws away, when an answer is complete before its request is.

    Closing at once would reset the connection, and a sender in the middle of a large body would never get to
    read why it was refused.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or not _has_body(Headers(scope=scope)):
            await self._app(scope, receive, send)
            return
        unread = True

        async def noted_receive() -> Message:
            nonlocal unread
            message = await receive()
            unread = message.get("more_body", False)
            return message

        async def lingering_send(message: Message) -> None:
            is_last = message["type"] == "http.response.body" and not message.get("more_body", False)
            if is_last and unread:
                await send({**message, "more_body": True})
                await _throw_away(receive)
                message = {"type": "http.response.body"}
            await send(message)

        await self._app(scope, noted_receive, lingering_send)


def _has_body(headers: Headers) -> bool:
    """Whether a body is on its way; one that waits for a "100 Continue" is not."""
    if "expect" in headers:
        return False
    return headers.get("content-length", "0") != "0" or "transfer-encoding" in headers


async def _throw_away(receive: Receive) -> None:
    end = time.monotonic() + LINGER_S
    while (left := end - time.monotonic()) > 0:
        try:
            message = await asyncio.wait_for(receive(), left)
        except TimeoutError:
            return
        if not message.get("more_body", False):
            return
