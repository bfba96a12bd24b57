"""Stands before every gRPC call: who calls. What the caller may do, the operations decide."""

from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any, TypeAlias

import grpc

from nocturne_api.access import CALLER, Caller, Pace, secret_in
from nocturne_api.rpc.failures import Answering

Context = grpc.aio.ServicerContext[Any, Any]
Handler: TypeAlias = "grpc.RpcMethodHandler[Any, Any]"

# Anybody may ask whether the service lives.
_OPEN = "/grpc.health.v1.Health/"


class Gate(grpc.aio.ServerInterceptor):
    """Lets callers with a token in, and all who come by the Unix socket, whose folder guards it."""

    def __init__(self, identify: Callable[[str], Awaitable[Caller]]) -> None:
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
        if handler.response_streaming:
            method = handler.unary_stream or handler.stream_stream

            async def stream(request: Any, context: Context) -> AsyncIterator[Any]:
                await self._admit(context)
                async for answer in method(request, context):
                    yield answer

            make = (
                grpc.stream_stream_rpc_method_handler
                if handler.request_streaming
                else grpc.unary_stream_rpc_method_handler
            )
            return make(stream, handler.request_deserializer, handler.response_serializer)
        call = handler.unary_unary or handler.stream_unary

        async def answer_one(request: Any, context: Context) -> Any:
            await self._admit(context)
            return await call(request, context)

        make_one = (
            grpc.stream_unary_rpc_method_handler
            if handler.request_streaming
            else grpc.unary_unary_rpc_method_handler
        )
        return make_one(answer_one, handler.request_deserializer, handler.response_serializer)

    async def _admit(self, context: Context) -> None:
        if context.peer().startswith("unix:"):
            return
        async with Answering(context):
            metadata = dict(context.invocation_metadata() or ())
            caller = await self._identify(secret_in(str(metadata.get("authorization", ""))))
            self._pace.take(caller.name)
            CALLER.set(caller)
