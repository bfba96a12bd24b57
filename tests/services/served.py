"""A real service in a thread of its own, for clients that block."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from nocturne_api.service import Service, Settings, open_service


@contextmanager
def served(settings: Settings) -> Iterator[Service]:
    """The service of `settings`, until the end of `with`."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()

    def wait_for_service() -> Service:
        async def start() -> Service:
            service = await open_service(settings)
            await service.start()
            return service

        return asyncio.run_coroutine_threadsafe(start(), loop).result(60)

    try:
        service = wait_for_service()
        try:
            yield service
        finally:
            asyncio.run_coroutine_threadsafe(service.stop(), loop).result(60)
    finally:
        loop.call_soon_threadsafe(loop.stop)
        thread.join(10)
        loop.close()
