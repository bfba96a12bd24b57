"""Long work, bounded: so much of it at once, so many that wait, and none that goes on unseen for callers who
left."""

import asyncio
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import ParamSpec, TypeVar

from nocturne_api.errors import Overloaded

_P = ParamSpec("_P")
_T = TypeVar("_T")


class Places:
    """So many may work at once, and so many wait for a place; others are refused until later."""

    def __init__(self, at_once: int, waiting: int, busy: str) -> None:
        """`busy`: the message for those."""
        self._free = asyncio.Semaphore(at_once)
        self._most = waiting
        self._busy = busy
        self._waiting = 0

    @asynccontextmanager
    async def one(self) -> AsyncIterator[None]:
        """Raises Overloaded; leaves the queue with its caller."""
        if self._free.locked() and self._waiting >= self._most:
            raise Overloaded(self._busy)
        self._waiting += 1
        try:
            await self._free.acquire()
        finally:
            self._waiting -= 1
        try:
            yield
        finally:
            self._free.release()


async def to_the_end(call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
    """Runs a call in a thread; who is cancelled meanwhile waits until it is over, for until then it needs its
    place, its memory and its files."""
    return await _watched(asyncio.create_task(asyncio.to_thread(call, *args, **kwargs)), threading.Event())


async def until_abandoned(call: Callable[[threading.Event], _T]) -> _T:
    """As `to_the_end`; the event tells the call that nobody waits for it any more."""
    abandoned = threading.Event()
    return await _watched(asyncio.create_task(asyncio.to_thread(call, abandoned)), abandoned)


async def _watched(running: "asyncio.Task[_T]", abandoned: threading.Event) -> _T:
    try:
        return await asyncio.shield(running)
    except asyncio.CancelledError:
        abandoned.set()
        await asyncio.wait([running])
        if not running.cancelled():
            running.exception()
        raise
