"""Puts the gRPC endpoint together: its services, made of their descriptors, health and reflection."""

from collections.abc import AsyncIterator
from contextlib import aclosing
from typing import Any

import grpc
from google.protobuf.descriptor import MethodDescriptor
from google.protobuf.message_factory import GetMessageClass
from grpc_health.v1 import health, health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection
from nocturne.v1 import asset_service_pb2, render_service_pb2, worker_service_pb2

from nocturne_api import limits
from nocturne_api.grpc.auth_interceptor import AuthInterceptor
from nocturne_api.grpc.calls import calls_of
from nocturne_api.grpc.conversion import message_of
from nocturne_api.grpc.failures import Answering
from nocturne_api.operations.operations import Operations

_OPTIONS = (
    ("grpc.max_receive_message_length", limits.GRPC_MESSAGE_BYTES),
    ("grpc.max_concurrent_streams", limits.GRPC_CALLS_OF_CONNECTION),
    # Who connects and says nothing.
    ("grpc.server_handshake_timeout_ms", int(1000 * limits.HEAD_SECONDS)),
    # Two servers on one port would each get half of the calls, silently.
    ("grpc.so_reuseport", 0),
)
SERVICES = [
    service
    for file in (render_service_pb2, asset_service_pb2, worker_service_pb2)
    for service in file.DESCRIPTOR.services_by_name.values()
]
_NAMES = [service.full_name for service in SERVICES]

Context = grpc.aio.ServicerContext[Any, Any]


class GrpcEndpoint:
    """A gRPC server over `operations` that reports its health."""

    def __init__(self, operations: Operations, authenticate: bool = False) -> None:
        self.server = grpc.aio.server(
            options=_OPTIONS,
            maximum_concurrent_rpcs=limits.GRPC_CALLS,
            interceptors=[
                AuthInterceptor(operations.identify if authenticate else None, operations.check_folder)
            ],
        )
        self._health = health.aio.HealthServicer()
        calls = calls_of(operations)
        for service in SERVICES:
            handlers = {method.name: _handler(method, calls[method.name]) for method in service.methods}
            handler = grpc.method_handlers_generic_handler(service.full_name, handlers)
            self.server.add_generic_rpc_handlers((handler,))
        health_pb2_grpc.add_HealthServicer_to_server(self._health, self.server)
        names = (*_NAMES, health.SERVICE_NAME, reflection.SERVICE_NAME)
        reflection.enable_server_reflection(names, self.server)

    async def start(self) -> None:
        """Takes calls on the addresses added to `server`."""
        await self.server.start()
        for name in ("", *_NAMES):
            await self._health.set(name, health_pb2.HealthCheckResponse.SERVING)

    async def stop(self, grace_s: float) -> None:
        """Reports NOT_SERVING, gives running calls `grace_s` seconds, and ends."""
        await self._health.enter_graceful_shutdown()
        await self.server.stop(grace_s)


def _handler(method: MethodDescriptor, call: Any) -> Any:
    """Gives the method's message to the call, and the call's answer to the caller as the method's message."""
    answer = GetMessageClass(method.output_type)

    async def one(request: Any, context: Context) -> Any:
        async with Answering(context):
            return message_of(await call(request), answer)

    async def several(request: Any, context: Context) -> AsyncIterator[Any]:
        async with Answering(context), aclosing(call(request)) as found:
            async for each in found:
                yield message_of(each, answer)

    coders = GetMessageClass(method.input_type).FromString, answer.SerializeToString
    if method.server_streaming:
        return grpc.unary_stream_rpc_method_handler(several, *coders)
    if method.client_streaming:
        return grpc.stream_unary_rpc_method_handler(one, *coders)
    return grpc.unary_unary_rpc_method_handler(one, *coders)
