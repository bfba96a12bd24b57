"""nocturne.v1.WorkerService over the operations."""

from dataclasses import asdict
from typing import Any

import grpc
from nocturne.v1 import worker_service_pb2 as pb
from nocturne.v1 import worker_service_pb2_grpc

from nocturne_api.grpc.failures import Answering
from nocturne_api.operations.operations import Operations

Context = grpc.aio.ServicerContext[Any, Any]


class WorkerService(worker_service_pb2_grpc.WorkerServiceServicer):
    """Calls one operation, puts its answer into a message."""

    def __init__(self, operations: Operations) -> None:
        self._operations = operations

    async def Enrol(self, request: pb.EnrolRequest, context: Context) -> pb.Enrolment:  # noqa: N802, ARG002
        async with Answering(context):
            return pb.Enrolment(**asdict(await self._operations.machines.enrol()))
