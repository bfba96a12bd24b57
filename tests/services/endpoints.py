"""Starts a real API and opens clients of its endpoints."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import grpc
import httpx
import pytest
from nocturne.v1 import asset_service_pb2, asset_service_pb2_grpc
from nocturne_api.service import Service, Settings, open_service


@asynccontextmanager
async def started(settings: Settings) -> AsyncIterator[Service]:
    """A service, stopped after `with` also where that fails.

    A gRPC server that outlives its event loop stops the next one in the process.
    """
    service = await open_service(settings)
    try:
        await service.start()
        yield service
    finally:
        await service.stop()


@asynccontextmanager
async def running(folder: Path, web: Path) -> AsyncIterator[Service]:
    """A service on free ports with its data in `folder`/data."""
    settings = Settings(data=folder / "data", web=web, port=0, grpc_port=0, grpc_unix=folder / "grpc.sock")
    async with started(settings) as service:
        yield service


def rest_client(service: Service) -> httpx.AsyncClient:
    """A client of the REST endpoint."""
    address = f"http://127.0.0.1:{service.port}"
    # No certificates, whose reading would take a hundred times as long as a request.
    return httpx.AsyncClient(base_url=address, timeout=300, trust_env=False, verify=False)  # noqa: S501


def grpc_channel(service: Service) -> grpc.aio.Channel:
    """A channel to the gRPC endpoint."""
    return grpc.aio.insecure_channel(f"127.0.0.1:{service.grpc_port}")


async def refusal_of_upload(
    service: Service,
    messages: Iterator[asset_service_pb2.UploadRequest],
    metadata: tuple[tuple[str, str], ...] = (),
) -> grpc.StatusCode:
    """With what status an upload ends that the service does not take.

    By gRPC's blocking client in a thread: a write of the asynchronous one that meets the end of its call
    puts "Internal error from Core" in the place of the service's status (grpc/grpc issue 36066).
    """

    def upload() -> grpc.StatusCode:
        with grpc.insecure_channel(f"127.0.0.1:{service.grpc_port}") as channel:
            stub = asset_service_pb2_grpc.AssetServiceStub(channel)
            with pytest.raises(grpc.RpcError) as caught:
                stub.Upload(messages, metadata=metadata, timeout=300)
            code: grpc.StatusCode = caught.value.code()
            return code

    return await asyncio.to_thread(upload)
