"""A service that asks for tokens, and callers of both its endpoints."""

import copy
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import grpc
import httpx
from nocturne.v1 import render_service_pb2 as pb
from nocturne_api.service import Service, Settings
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.conftest import SCENE
from tests.services.endpoints import grpc_channel, started


@dataclass
class Guarded:
    """The service, and its data folder as another process sees it."""

    service: Service
    folder: DataFolder

    def token(self, name: str, *scopes: str) -> str:
        return self.folder.tokens.create(name, scopes)

    def rest(self, token: str) -> httpx.AsyncClient:
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        address = f"http://127.0.0.1:{self.service.port}"
        return httpx.AsyncClient(
            base_url=address,
            timeout=300,
            trust_env=False,
            headers=headers,
            verify=False,  # noqa: S501
        )

    def grpc(self) -> grpc.aio.Channel:
        return grpc_channel(self.service)


@asynccontextmanager
async def guarded(folder: Path, **settings: Any) -> AsyncIterator[Guarded]:
    """A service with its data in `folder`/data."""
    asked = Settings(data=folder / "data", web=folder, port=0, grpc_port=0, auth=True, **settings)
    async with started(asked) as service:
        with closing(DataFolder(folder / "data")) as other:
            yield Guarded(service, other)


def request(request_id: str, **changes: Any) -> dict[str, Any]:
    """What creates a small render."""
    body = {"request_id": request_id, "scene": copy.deepcopy(SCENE), "width": 40, "height": 30, "samples": 16}
    return {**body, **changes}


def metadata(token: str) -> tuple[tuple[str, str]]:
    """The same for gRPC."""
    return (("authorization", f"Bearer {token}"),)


async def next_of(stream: grpc.aio.UnaryStreamCall[Any, pb.Render]) -> pb.Render:
    """The next state in a stream that is not over."""
    found = await stream.read()
    assert isinstance(found, pb.Render)
    return found
