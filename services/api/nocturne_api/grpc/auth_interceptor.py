"""Authenticates every gRPC call, and refuses messages that can't be read. The operations decide what the
caller may do."""

import asyncio
import time
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any, TypeAlias

import grpc
from google.protobuf.message import DecodeError
from nocturne_scene.errors import InputError

from nocturne_api import limits
from nocturne_api.access import CALLER, Authenticator, Caller, secret_in
from nocturne_api.errors import Overloaded, RequestTimedOut
from nocturne_api.grpc.failures import Answering

Context = grpc.aio.ServicerContext[Any, Any]
Handler: TypeAlias = "grpc.RpcMethodHandler[Any, Any]"

# Health checks need no token.
_OPEN = "/grpc.health.v1.Health/"

_UNREADABLE = object()
"""In the place of a message that is none. gRPC would answer UNKNOWN, and log it as an error of ours."""


class AuthInterceptor(grpc.aio.ServerInterceptor):
    """Admits callers with a token, and all by the Unix socket, which its folder's permissions protect."""

    def __init__(
        self, identify: Callable[[str], Awaitable[Caller]] | None, check_folder: Callable[[], None]
    ) -> None:
        """`identify` gives who has a secret; without it, anybody may do anything. `check_folder` raises where
        the data folder is gone."""
        self._check_folder = check_folder
        self._authenticator = None if identify is None else Authenticator(identify)
        self._calls: Counter[str] = Counter()

    async def intercept_service(
        self,
        continuation: Callable[[grpc.HandlerCallDetails], Awaitable["Handler | None"]],
        handler_call_details: grpc.HandlerCallDetails,
    ) -> "Handler | None":
        handler: Any = await continuation(handler_call_details)
        if handler is None:
            return None
        if handler_call_details.method.startswith(_OPEN):
            found: Handler = handler
            return found
        read = _reader(handler.request_deserializer)
        if handler.response_streaming:
            method = handler.unary_stream or handler.stream_stream

            async def stream(request: Any, context: Context) -> AsyncIterator[Any]:
                async with self._counted(context):
                    async for answer in method(await self._admitted(request, context), context):
                        yield answer

            make = (
                grpc.stream_stream_rpc_method_handler
                if handler.request_streaming
                else grpc.unary_stream_rpc_method_handler
            )
            return make(stream, read, handler.response_serializer)
        call = handler.unary_unary or handler.stream_unary

        async def answer_one(request: Any, context: Context) -> Any:
            async with self._counted(context):
                return await call(await self._admitted(request, context), context)

        make_one = (
            grpc.stream_unary_rpc_method_handler
            if handler.request_streaming
            else grpc.unary_unary_rpc_method_handler
        )
        return make_one(answer_one, read, handler.response_serializer)

    @asynccontextmanager
    async def _counted(self, context: Context) -> AsyncIterator[None]:
        """Ends the call where its address has too many in progress."""
        address = _address(context.peer())
        async with Answering(context):
            if self._calls[address] >= limits.GRPC_CALLS_OF_ADDRESS:
                most = limits.GRPC_CALLS_OF_ADDRESS
                raise Overloaded(f"{most} calls of this address are in progress; end some and try again.")
        self._calls[address] += 1
        try:
            yield
        finally:
            self._calls[address] -= 1
            self._calls += Counter()

    async def _admitted(self, request: Any, context: Context) -> Any:
        """The request, or those that stream in, once the caller is known; else the call ends here."""
        async with Answering(context):
            self._check_folder()
            if self._authenticator is not None and not context.peer().startswith("unix:"):
                metadata = dict(context.invocation_metadata() or ())
                secret = secret_in(str(metadata.get("authorization", "")))
                CALLER.set(await self._authenticator.authenticate(secret, _address(context.peer())))
            return _all_readable(request) if hasattr(request, "__aiter__") else _readable(request)


def _reader(deserialize: Callable[[bytes], Any]) -> Callable[[bytes], Any]:
    def read(data: bytes) -> Any:
        try:
            return deserialize(data)
        except DecodeError:
            return _UNREADABLE

    return read


def _readable(request: Any) -> Any:
    if request is _UNREADABLE:
        raise InputError.at("message", "can't be read as the protobuf message that this call takes")
    return request


async def _all_readable(requests: AsyncIterator[Any]) -> AsyncIterator[Any]:
    """As they come, unless they come too slowly."""
    left = limits.BODY_SECONDS
    while True:
        begun = time.monotonic()
        try:
            request = await asyncio.wait_for(anext(requests, None), left)
        except TimeoutError:
            raise RequestTimedOut("the messages of this call came too slowly; try again") from None
        if request is None:
            return
        yield _readable(request)
        size = 0 if request is _UNREADABLE else request.ByteSize()
        # Unused time is not saved up; received bytes alone add to it.
        left += size / limits.BODY_BYTES_PER_SECOND - (time.monotonic() - begun)
        left = min(max(left, 0.0), limits.BODY_SECONDS)


def _address(peer: str) -> str:
    """Without its port: "ipv4:192.0.2.1:5000" is "ipv4:192.0.2.1"."""
    return peer if peer.startswith("unix:") else peer.rpartition(":")[0]
