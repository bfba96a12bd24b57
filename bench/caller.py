"""`python -m bench.caller URL GRPC`: another caller, by both transports; at SIGTERM one line of JSON.

It calls from an address of this machine that no other program uses, one call after another, and reports how
long each kind of call waited for its answer, in seconds.
"""

import json
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Callable

import grpc
import httpx
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc

_ADDRESS = "127.0.0.9"
_PAUSE_S = 0.05
_TIMEOUT_S = 120.0


class _Over(Exception):
    """Enough was asked."""


def main(url: str, target: str) -> None:
    """Calls until SIGTERM."""
    waits: dict[str, list[float]] = defaultdict(list)
    transport = httpx.HTTPTransport(local_address=_ADDRESS)
    channel = grpc.insecure_channel(target)
    stub = render_service_pb2_grpc.RenderServiceStub(channel)

    def over(*_: object) -> None:
        raise _Over

    signal.signal(signal.SIGTERM, over)
    with httpx.Client(base_url=url, transport=transport, timeout=_TIMEOUT_S, trust_env=False) as client:
        calls: dict[str, Callable[[], object]] = {
            "healthz": lambda: client.get("/healthz").raise_for_status(),
            "list": lambda: client.get("/v1/renders").raise_for_status(),
            "gRPC list": lambda: stub.ListRenders(
                render_service_pb2.ListRendersRequest(), timeout=_TIMEOUT_S
            ),
        }
        try:
            while True:
                for name, call in calls.items():
                    begun = time.monotonic()
                    call()
                    waits[name].append(time.monotonic() - begun)
                    time.sleep(_PAUSE_S)
        except _Over:
            print(json.dumps(waits))


if __name__ == "__main__":
    main(*sys.argv[1:])
