"""`nocturne-api`: the API process."""

import argparse
import asyncio
import ipaddress
import logging
import signal
import sys
from pathlib import Path

from nocturne_coordinator.log_lines import write_log_lines
from nocturne_scene.errors import NocturneError

from nocturne_api.addresses import AddressError
from nocturne_api.compiling.pool import CompileLimits
from nocturne_api.rest.page import built_page
from nocturne_api.service import Settings, open_service

_log = logging.getLogger("nocturne_api")


def main() -> None:
    """Runs until SIGINT or SIGTERM; SIGHUP reads the certificate again.

    Exit status: 0 stopped, 2 can't start (standard error says why).
    """
    write_log_lines("info", "api")
    try:
        asyncio.run(_run(_settings()))
    except (AddressError, NocturneError, OSError) as error:
        sys.exit(_failed(str(error)))


def _failed(message: str) -> int:
    sys.stderr.write(f"nocturne-api: {message}\n")
    return 2


def _settings() -> Settings:
    parser = argparse.ArgumentParser(
        prog="nocturne-api", description="REST, gRPC and the web page on one data folder."
    )
    parser.add_argument("--data", type=Path, required=True, help="data folder, shared with the coordinator")
    parser.add_argument("--host", default="127.0.0.1", help="address of REST and gRPC (default: %(default)s)")
    parser.add_argument("--port", type=int, default=7070, help="REST and page (default: %(default)s)")
    parser.add_argument("--grpc-port", type=int, default=7071, help="gRPC (default: %(default)s)")
    parser.add_argument("--grpc-unix", type=Path, metavar="PATH", help="gRPC on a Unix socket as well")
    parser.add_argument("--web", type=Path, default=built_page(), help="folder of the built page")
    parser.add_argument(
        "--insecure-any-address",
        dest="any_address",
        action="store_true",
        help="allow a --host that others can reach, without tokens or without TLS",
    )
    parser.add_argument(
        "--auth", action="store_true", help="callers need a token, made by `nocturne token create`"
    )
    parser.add_argument(
        "--tls-certificate",
        type=Path,
        metavar="PEM",
        help="for REST and gRPC; read again when it is renewed, and at SIGHUP",
    )
    parser.add_argument("--tls-key", type=Path, metavar="PEM")
    parser.add_argument(
        "--compile-memory-bytes",
        type=int,
        default=CompileLimits.memory_bytes,
        help="address space that compiling one scene may take (default: %(default)s)",
    )
    parser.add_argument(
        "--compile-seconds",
        type=int,
        default=CompileLimits.cpu_seconds,
        help="processor time that compiling one scene may take (default: %(default)s)",
    )
    parser.add_argument(
        "--behind-proxy",
        action="store_true",
        help="believe X-Forwarded-Proto and -For of a proxy before REST: the page's cookie is Secure where "
        "that speaks https, and addresses are its callers'; only where nobody else reaches the port",
    )
    _add_quotas(parser)
    _add_storage(parser)
    parser.add_argument(
        "--core-hour-price",
        type=float,
        metavar="PRICE",
        default=Settings.core_hour_price,
        help="of an hour of one worker's processor: shows what renders and owners cost; 0: it is not "
        "shown (default: %(default)g)",
    )
    parser.add_argument(
        "--currency", default=Settings.currency, help="of that price, as it is shown (default: %(default)s)"
    )
    parser.add_argument(
        "--objects",
        default="",
        metavar="URL",
        help="object store for assets and finished images: s3://BUCKET/PREFIX, with credentials and address "
        "from AWS_... in the environment, or file:///FOLDER",
    )
    parser.add_argument(
        "--webhook-network",
        dest="webhook_networks",
        type=ipaddress.ip_network,
        action="append",
        default=[],
        metavar="CIDR",
        help="a private network that webhooks may lead to, also by http; may be given several times",
    )
    return Settings(**vars(parser.parse_args()))


def _add_quotas(parser: argparse.ArgumentParser) -> None:
    quotas = parser.add_argument_group(
        "quotas", "What each owner (each token) may have; more is answered by 429 or RESOURCE_EXHAUSTED."
    )
    quotas.add_argument(
        "--owner-open-renders",
        type=float,
        metavar="N",
        default=Settings.owner_open_renders,
        help="renders that are queued, running or paused (default: %(default)s)",
    )
    quotas.add_argument(
        "--owner-open-samples",
        type=float,
        metavar="N",
        default=Settings.owner_open_samples,
        help="samples of pixels (width x height x samples) that these ask for (default: %(default)g)",
    )
    quotas.add_argument(
        "--owner-stored-bytes",
        type=float,
        metavar="N",
        default=Settings.owner_stored_bytes,
        help="uploads, and sums, images and scenes of renders (default: %(default)s)",
    )


def _add_storage(parser: argparse.ArgumentParser) -> None:
    storage = parser.add_argument_group("storage")
    storage.add_argument(
        "--data-bytes",
        type=float,
        metavar="N",
        default=Settings.data_bytes,
        help="size of the data folder at which uploads and renders are refused; from nine tenths on the log "
        "warns; 0: none (default: %(default)g)",
    )
    storage.add_argument(
        "--unused-seconds",
        type=float,
        metavar="S",
        default=Settings.unused_seconds,
        help="how long files stay that no render uses (default: %(default)g, a week)",
    )


async def _run(settings: Settings) -> None:
    service = await open_service(settings)
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stop.set)
    loop.add_signal_handler(signal.SIGHUP, service.reload)
    await service.start()
    log = logging.getLogger("nocturne_api")
    log.info(
        "REST and page at http://%s:%d, gRPC at %s:%d",
        settings.host,
        service.port,
        settings.host,
        service.grpc_port,
    )
    await stop.wait()
    await service.stop()


if __name__ == "__main__":
    main()
