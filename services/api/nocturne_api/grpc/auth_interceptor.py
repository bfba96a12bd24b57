"""Authenticates every gRPC call, and refuses messages that can't be read. The operations decide what the
caller may do."""

from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any, TypeAlias

import grpc
from google.protobuf.message import DecodeError
from nocturne_scene.errors import InputError

from nocturne_api.access import CALLER, Caller, Pace, secret_in
from nocturne_api.grpc.failures import Answering

Context = grpc.aio.ServicerContext[Any, Any]
Handler: TypeAlias = "grpc.RpcMethodHandler[Any, Any]"

# Health checks need no token.
_OPEN = "/grpc.health.v1.Health/"

_UNREADABLE = object()
"""In the place of a message that is none. gRPC would answer UNKNOWN, and log it as an error of ours."""


class AuthInterceptor(grpc.aio.ServerInterceptor):
    """Admits callers with a token, and all by the Unix socket, which its folder's permissions protect."""

    def __init__(self, identify: Callable[[str], Awaitable[Caller]] | None) -> None:
        """`identify` gives who has a secret; without it, anybody may do anything."""
        self._identify = identify
        self._pace = Pace()

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
            return await call(await self._admitted(request, context), context)

        make_one = (
            grpc.stream_unary_rpc_method_handler
            if handler.request_streaming
            else grpc.unary_unary_rpc_method_handler
        )
        return make_one(answer_one, read, handler.response_serializer)

    async def _admitted(self, request: Any, context: Context) -> Any:
        """The request, or those that stream in, once the caller is known; else the call ends here."""
        async with Answering(context):
            if self._identify is not None and not context.peer().startswith("unix:"):
                metadata = dict(context.invocation_metadata() or ())
                caller = await self._identify(secret_in(str(metadata.get("authorization", ""))))
                self._pace.take(caller.name)
                CALLER.set(caller)
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
    async for request in requests:
        yield _readable(request)
