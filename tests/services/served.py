"""A real service in a separate thread, for clients that block."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from nocturne_api.service import Service, Settings

from tests.services.endpoints import started


@contextmanager
def served(settings: Settings) -> Iterator[Service]:
    """The service of `settings`, until the end of `with`."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    service = started(settings)
    try:
        entered = asyncio.run_coroutine_threadsafe(service.__aenter__(), loop).result(60)
        try:
            yield entered
        finally:
            asyncio.run_coroutine_threadsafe(service.__aexit__(None, None, None), loop).result(60)
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join(10)
        loop.close()
