"""Uvicorn's HTTP protocol with bounds that it does not have: of time for requests, and of connections of one
address (docs/decisions/0050-uvicorn-with-bounds.md)."""

import asyncio
import time

import h11
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from nocturne_api import limits
from nocturne_api.errors import Overloaded, RequestTimedOut, failure_of
from nocturne_api.limits import LINGER_S
from nocturne_api.rest.problems import response_of


class BoundedProtocol(H11Protocol):
    """One connection. Who sends nothing, or slowly, is cut off, and makes room for others before that."""

    _timer: asyncio.TimerHandle | None = None
    _since = 0.0
    """When head or body began."""
    _received = 0
    """Bytes of the body."""
    _stalled: asyncio.TimerHandle | None = None

    @property
    def waits(self) -> bool:
        """Whether no request is being answered: none has come, or none as a whole."""
        return self.cycle is None or self.cycle.response_complete

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._expect_head()
        self._make_room()

    def connection_lost(self, exc: Exception | None) -> None:
        self._forget_timers()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        if self.waits and self._timer is None:
            self._expect_head()
        waited = self.waits
        super().data_received(data)
        if self.waits or self.transport.is_closing():
            return
        if self.conn.their_state is not h11.SEND_BODY:
            self._forget_timer()
        elif waited:
            self._forget_timer()
            self._since, self._received = self.loop.time(), 0
            self._timer = self.loop.call_later(limits.BODY_SECONDS, self._check_body)
        else:
            self._received += len(data)

    def on_response_complete(self) -> None:
        self._forget_timer()
        super().on_response_complete()

    def pause_writing(self) -> None:
        super().pause_writing()
        self._stalled = self.loop.call_later(limits.UNREAD_SECONDS, self.transport.abort)

    def resume_writing(self) -> None:
        super().resume_writing()
        if self._stalled is not None:
            self._stalled.cancel()
            self._stalled = None

    def refuse(self, error: Exception) -> None:
        """Answers with a problem if that can still be done, and closes."""
        self._forget_timers()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            response = response_of(failure_of(error), {"Connection": "close"})
            head = h11.Response(status_code=response.status_code, headers=response.raw_headers)
            parts: list[h11.Event] = [head, h11.Data(data=bytes(response.body)), h11.EndOfMessage()]
            for part in parts:
                self.transport.write(self.conn.send(part) or b"")
        self.transport.close()

    def _expect_head(self) -> None:
        self._since = self.loop.time()
        self._timer = self.loop.call_later(limits.HEAD_SECONDS, self._head_is_late)

    def _head_is_late(self) -> None:
        seconds = limits.HEAD_SECONDS
        self.refuse(
            RequestTimedOut(f"the head of the request did not come in {seconds:g} s; send it at once")
        )

    def _check_body(self) -> None:
        """Cuts off a body that comes more slowly than it must; while we do not read, that is our doing."""
        now = self.loop.time()
        if self.flow.read_paused:
            self._since, self._received = now, 0
        due = self._since + limits.BODY_SECONDS + self._received / limits.BODY_BYTES_PER_SECOND
        if now < due:
            self._timer = self.loop.call_later(due - now, self._check_body)
            return
        rate = limits.BODY_BYTES_PER_SECOND
        self.refuse(
            RequestTimedOut(f"the body of the request came with less than {rate:g} bytes a second; try again")
        )

    def _make_room(self) -> None:
        """The oldest connection on which nothing is asked goes for a new one; without such, this one goes."""
        everybody = [each for each in self.connections if isinstance(each, BoundedProtocol)]
        if len(everybody) >= limits.CONNECTIONS_OF_ADDRESS:
            address = _address(self)
            same = [each for each in everybody if _address(each) == address]
            if len(same) > limits.CONNECTIONS_OF_ADDRESS and not self._evict(same):
                most = limits.CONNECTIONS_OF_ADDRESS
                self.refuse(Overloaded(f"{most} connections of this address are in use; close some."))
        # Uvicorn answers 503 where this finds nobody.
        if len(everybody) >= limits.REST_CONNECTIONS:
            self._evict(everybody)

    def _evict(self, connections: "list[BoundedProtocol]") -> bool:
        idle = [each for each in connections if each.waits and each is not self]
        if not idle:
            return False
        oldest = min(idle, key=lambda each: each._since)
        self.connections.discard(oldest)
        oldest.transport.abort()
        return True

    def _forget_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _forget_timers(self) -> None:
        self._forget_timer()
        if self._stalled is not None:
            self._stalled.cancel()
            self._stalled = None


def _address(connection: BoundedProtocol) -> str:
    return connection.client[0] if connection.client else ""


class LeavingMiddleware:
    """Cancels a call whose caller closes the connection before the answer is complete, as gRPC does."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        whole, left, answered = asyncio.Event(), asyncio.Event(), False
        # Without a body the application may never ask for one; its end is reported here.
        given = [] if _may_have_body(Headers(scope=scope)) else [{"type": "http.request", "body": b""}]
        if given:
            whole.set()

        async def noted_receive() -> Message:
            if given:
                return given.pop()
            if whole.is_set():
                await left.wait()
                return {"type": "http.disconnect"}
            message = await receive()
            if not message.get("more_body", False):
                whole.set()
            return message

        async def noted_send(message: Message) -> None:
            nonlocal answered
            answered = message["type"] == "http.response.body" and not message.get("more_body", False)
            await send(message)

        async def watch() -> None:
            await whole.wait()
            while (await receive())["type"] != "http.disconnect":
                pass
            left.set()
            if not answered:
                call.cancel()

        call = asyncio.ensure_future(self._app(scope, noted_receive, noted_send))
        watching = asyncio.create_task(watch())
        try:
            await asyncio.shield(call)
        except asyncio.CancelledError:
            if not left.is_set():
                call.cancel()
                raise
        finally:
            watching.cancel()


def _may_have_body(headers: Headers) -> bool:
    return headers.get("content-length", "0") != "0" or "transfer-encoding" in headers


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
    """Whether a body is being received; one that waits for a "100 Continue" is not."""
    if "expect" in headers:
        return False
    return _may_have_body(headers)


async def _throw_away(receive: Receive) -> None:
    end = time.monotonic() + LINGER_S
    while (left := end - time.monotonic()) > 0:
        try:
            message = await asyncio.wait_for(receive(), left)
        except TimeoutError:
            return
        if not message.get("more_body", False):
            return
