"""Both endpoints, REST and gRPC, in one event loop, started and stopped together."""

import asyncio
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import uvicorn
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.quotas import Quota
from nocturne_coordinator.traces import start_traces

from nocturne_api import limits
from nocturne_api.addresses import AddressError, check_host, listen
from nocturne_api.background.space import StorageLimits
from nocturne_api.certificate import Certificate
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.grpc.server import GrpcEndpoint
from nocturne_api.models.workers import CoreHourPrice
from nocturne_api.operations.operations import Operations
from nocturne_api.rest.app import build_rest
from nocturne_api.rest.protocol import BoundedProtocol
from nocturne_api.webhooks.targets import Network, TargetRules

# Running calls get this long when the service stops, seconds; streams are ended at once.
_GRACE_S = 3.0


@dataclass(frozen=True)
class Settings:
    """How to serve: a data folder, addresses (port 0 takes a free one), and the folder of the built page."""

    data: Path
    web: Path
    host: str = "127.0.0.1"
    port: int = 7070
    grpc_port: int = 7071
    grpc_unix: Path | None = None
    any_address: bool = False
    auth: bool = False
    """Callers need a token."""
    behind_proxy: bool = False
    """A proxy asks, whose X-Forwarded-Proto and -For are believed."""
    tls_certificate: Path | None = None
    tls_key: Path | None = None
    compile_memory_bytes: int = CompileLimits.memory_bytes
    compile_seconds: int = CompileLimits.cpu_seconds
    webhook_networks: Sequence[Network] = ()
    """Private networks that webhooks may lead to."""
    owner_open_renders: float = limits.OWNER_OPEN_RENDERS
    owner_open_samples: float = limits.OWNER_OPEN_SAMPLES
    owner_stored_bytes: float = limits.OWNER_STORED_BYTES
    """What each owner may have, with authentication: see Quota."""
    unused_seconds: float = limits.UNUSED_SECONDS
    """How long files stay that no render uses."""
    data_bytes: float = 0.0
    """Size of the data folder at which it takes no more; 0: none."""
    core_hour_price: float = 0.0
    """Of an hour of one worker's processor; 0: none is shown."""
    currency: str = "EUR"
    objects: str = ""
    """Address of an object store for assets and finished images; empty: none."""


class _HttpServer(uvicorn.Server):
    """Uvicorn without its signal handlers: the process has one place that decides when to stop."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


class Service:
    """A running service: `port` and `grpc_port` are where it listens."""

    def __init__(self, settings: Settings, operations: Operations) -> None:
        """Takes the addresses; raises AddressError where that fails."""
        self.certificate = _certificate(settings)
        guarded = settings.auth and self.certificate is not None
        loopback = check_host(settings.host, settings.any_address or guarded)
        self._operations = operations
        if self.certificate is not None:
            operations.health.certificate = self.certificate
        self._grpc = GrpcEndpoint(operations, settings.auth)
        self._listener = listen(settings.host, settings.port)
        self.port: int = self._listener.getsockname()[1]
        self.grpc_port = self._take_grpc_addresses(settings)
        config = uvicorn.Config(
            build_rest(operations, settings.web, loopback, settings.auth),
            http=BoundedProtocol,
            ssl_certfile=settings.tls_certificate if self.certificate else None,
            ssl_keyfile=settings.tls_key if self.certificate else None,
            log_level="warning",
            access_log=False,
            limit_concurrency=limits.REST_CONNECTIONS,
            server_header=False,
            # Uvicorn believes whoever asks from this machine, unless an option says not to.
            proxy_headers=settings.behind_proxy,
            forwarded_allow_ips="*",
            timeout_graceful_shutdown=int(_GRACE_S),
            lifespan="off",
        )
        if self.certificate is not None:
            config.load()
            assert config.ssl is not None  # noqa: S101 - it has a certificate
            self.certificate.serve(config.ssl)
        self._http = _HttpServer(config)
        self._serving: asyncio.Task[None] | None = None

    def _take_grpc_addresses(self, settings: Settings) -> int:
        host = f"[{settings.host}]" if ":" in settings.host else settings.host
        addresses = [f"{host}:{settings.grpc_port}"]
        if settings.grpc_unix is not None:
            addresses.append(f"unix:{settings.grpc_unix.absolute()}")
        try:
            port = (
                self._grpc.server.add_secure_port(addresses[0], self.certificate.grpc_credentials())
                if self.certificate
                else self._grpc.server.add_insecure_port(addresses[0])
            )
            for address in addresses[1:]:
                self._grpc.server.add_insecure_port(address)
            return port
        except RuntimeError as error:
            self._listener.close()
            raise AddressError(
                f"can't listen on {' or '.join(addresses)}. Choose another --grpc-port."
            ) from error

    async def start(self) -> None:
        """Takes requests at both endpoints."""
        await self._grpc.start()
        if self.certificate is not None:
            self.certificate.start()
        self._serving = asyncio.create_task(self._http.serve(sockets=[self._listener]))
        # Uvicorn offers a flag, no event.
        while not self._http.started and not self._serving.done():  # noqa: ASYNC110
            await asyncio.sleep(0.01)

    def reload(self) -> None:
        """Reads the certificate again."""
        if self.certificate is not None:
            self.certificate.reload()

    async def end_streams(self) -> None:
        """Ends all streams; watchers see their end after the states at hand."""
        await self._operations.streams.close()

    async def stop(self) -> None:
        """Ends streams, finishes running calls, closes both endpoints and the data folder."""
        await self.end_streams()
        if self.certificate is not None:
            await self.certificate.close()
        self._http.should_exit = True
        await self._grpc.stop(_GRACE_S)
        if self._serving is not None:
            await self._serving
        await self._operations.close()


def _certificate(settings: Settings) -> Certificate | None:
    if settings.tls_certificate is None or settings.tls_key is None:
        return None
    return Certificate(settings.tls_certificate, settings.tls_key)


async def open_service(settings: Settings) -> Service:
    """A service on the data folder, not started yet. Raises AddressError, UnusableFolder."""
    compile_limits = CompileLimits(settings.compile_memory_bytes, settings.compile_seconds)
    rules = TargetRules(settings.webhook_networks)
    objects = ObjectStore(settings.objects) if settings.objects else None
    storage = StorageLimits(settings.unused_seconds, settings.data_bytes)
    quota = Quota(settings.owner_open_renders, settings.owner_open_samples, settings.owner_stored_bytes)
    price = CoreHourPrice(settings.core_hour_price, settings.currency)
    operations = await Operations.open(
        settings.data, compile_limits, rules, objects, quota, storage, price, start_traces("api")
    )
    try:
        return Service(settings, operations)
    except BaseException:
        await operations.close()
        raise
