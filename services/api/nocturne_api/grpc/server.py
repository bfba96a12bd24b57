"""Puts the gRPC endpoint together: its services, health and reflection."""

import grpc
from grpc_health.v1 import health, health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection
from nocturne.v1 import (
    asset_service_pb2,
    asset_service_pb2_grpc,
    render_service_pb2,
    render_service_pb2_grpc,
    worker_service_pb2,
    worker_service_pb2_grpc,
)

from nocturne_api import limits
from nocturne_api.grpc.asset_service import AssetService
from nocturne_api.grpc.auth_interceptor import AuthInterceptor
from nocturne_api.grpc.render_service import RenderService
from nocturne_api.grpc.worker_service import WorkerService
from nocturne_api.operations.operations import Operations

_OPTIONS = (
    ("grpc.max_receive_message_length", limits.GRPC_MESSAGE_BYTES),
    ("grpc.max_concurrent_streams", limits.GRPC_CALLS_OF_CONNECTION),
    # Who connects and says nothing.
    ("grpc.server_handshake_timeout_ms", int(1000 * limits.HEAD_SECONDS)),
    # Two servers on one port would each get half of the calls, silently.
    ("grpc.so_reuseport", 0),
)
_SERVICES = (
    render_service_pb2.DESCRIPTOR.services_by_name["RenderService"].full_name,
    asset_service_pb2.DESCRIPTOR.services_by_name["AssetService"].full_name,
    worker_service_pb2.DESCRIPTOR.services_by_name["WorkerService"].full_name,
)


class GrpcEndpoint:
    """A gRPC server over `operations` that reports its health."""

    def __init__(self, operations: Operations, authenticate: bool = False) -> None:
        self.server = grpc.aio.server(
            options=_OPTIONS,
            maximum_concurrent_rpcs=limits.GRPC_CALLS,
            interceptors=[AuthInterceptor(operations.tokens.identify if authenticate else None)],
        )
        self._health = health.aio.HealthServicer()
        render_service_pb2_grpc.add_RenderServiceServicer_to_server(RenderService(operations), self.server)
        asset_service_pb2_grpc.add_AssetServiceServicer_to_server(AssetService(operations), self.server)
        worker_service_pb2_grpc.add_WorkerServiceServicer_to_server(WorkerService(operations), self.server)
        health_pb2_grpc.add_HealthServicer_to_server(self._health, self.server)
        names = (*_SERVICES, health.SERVICE_NAME, reflection.SERVICE_NAME)
        reflection.enable_server_reflection(names, self.server)

    async def start(self) -> None:
        """Takes calls on the addresses added to `server`."""
        await self.server.start()
        for name in ("", *_SERVICES):
            await self._health.set(name, health_pb2.HealthCheckResponse.SERVING)

    async def stop(self, grace_s: float) -> None:
        """Reports NOT_SERVING, gives running calls `grace_s` seconds, and ends."""
        await self._health.enter_graceful_shutdown()
        await self.server.stop(grace_s)
