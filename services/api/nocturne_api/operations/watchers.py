"""Who is told of changes: one poller per process, any number of watchers, each holding newest states only.

A watcher that reads slowly skips states, never queues them: what it waits on is a slot per render that every
change overwrites. The poller runs only while somebody watches.
"""

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

from nocturne_api.errors import Overloaded
from nocturne_api.limits import WATCH_INTERVAL_S, WATCHERS
from nocturne_api.models.renders import Render

_log = logging.getLogger(__name__)


class Watcher:
    """The newest unread state of each render that one caller watches."""

    def __init__(self, render_ids: frozenset[str] | None) -> None:
        """`render_ids`: None for the newest, whichever they are."""
        self.render_ids = render_ids
        self._newest: dict[str, Render] = {}
        self._sent: dict[str, int] = {}
        self._awake = asyncio.Event()
        self._closed = False

    def offer(self, render: Render) -> None:
        """Takes a state, unless this watcher has seen it or one after it."""
        if render.sequence > self._sent.get(render.id, -1):
            self._newest[render.id] = render
            self._awake.set()

    def already_has(self, render_id: str, sequence: int) -> None:
        """Leaves out states up to `sequence`, which the caller knows from an earlier connection."""
        self._sent[render_id] = sequence

    def close(self) -> None:
        """Ends the stream after the states at hand."""
        self._closed = True
        self._awake.set()

    async def next(self) -> Render | None:
        """The next state, waiting for one; None when the stream is over."""
        while not self._newest:
            if self._closed:
                return None
            self._awake.clear()
            await self._awake.wait()
        render_id = next(iter(self._newest))
        render = self._newest.pop(render_id)
        self._sent[render_id] = render.sequence
        return render

    def forget_except(self, render_ids: Iterable[str]) -> None:
        """Drops what is known of renders that are no longer in sight, so that memory stays bounded."""
        kept = set(render_ids)
        self._sent = {key: value for key, value in self._sent.items() if key in kept}


class Watchers:
    """All watchers of this process, and the task that feeds them.

    `change_counter` is cheap and differs whenever something changed; `get_one` gives one render, None if it
    is gone; `newest` gives the newest page of renders, for those who watch all.
    """

    def __init__(
        self,
        change_counter: Callable[[], Awaitable[int]],
        get_one: Callable[[str], Awaitable[Render | None]],
        newest: Callable[[], Awaitable[list[Render]]],
    ) -> None:
        self._change_counter = change_counter
        self._get_one = get_one
        self._newest = newest
        self._watchers: set[Watcher] = set()
        self._poller: asyncio.Task[None] | None = None
        self._closed = False

    @contextmanager
    def watching(self, render_ids: frozenset[str] | None) -> Iterator[Watcher]:
        """A watcher of these renders, or of all where that is None; raises Overloaded."""
        if len(self._watchers) >= WATCHERS:
            raise Overloaded(f"{WATCHERS} watchers are connected to this service; close some and try again.")
        watcher = Watcher(render_ids)
        self._watchers.add(watcher)
        if self._closed:
            watcher.close()
        elif self._poller is None or self._poller.done():
            self._poller = asyncio.create_task(self._poll())
        try:
            yield watcher
        finally:
            self._watchers.discard(watcher)

    async def close(self) -> None:
        """Ends every stream, for a clean stop of the process."""
        self._closed = True
        for watcher in self._watchers:
            watcher.close()
        if self._poller is not None:
            self._poller.cancel()
            with suppress(asyncio.CancelledError):
                await self._poller

    async def _poll(self) -> None:
        """Runs until nobody watches. An error ends all streams, so that callers connect again and see it."""
        last: int | None = None
        try:
            while self._watchers:
                counter = await self._change_counter()
                # A counter seen before the read: a change in between is read twice rather than lost.
                if counter != last:
                    last = counter
                    await self._feed()
                await asyncio.sleep(WATCH_INTERVAL_S)
        except Exception:
            _log.exception("watching the data folder failed")
            for watcher in self._watchers:
                watcher.close()

    async def _feed(self) -> None:
        for render_id in frozenset().union(*(each.render_ids or () for each in self._watchers)):
            render = await self._get_one(render_id)
            for watcher in [each for each in self._watchers if render_id in (each.render_ids or ())]:
                if render is None:
                    watcher.close()
                else:
                    watcher.offer(render)
        if any(each.render_ids is None for each in self._watchers):
            await self._feed_all()

    async def _feed_all(self) -> None:
        renders = await self._newest()
        for watcher in [each for each in self._watchers if each.render_ids is None]:
            # Oldest first, so that a page which shows newest on top ends in the right order.
            for render in reversed(renders):
                watcher.offer(render)
            watcher.forget_except(render.id for render in renders)


async def states(watcher: Watcher, to_the_end: bool = False) -> AsyncIterator[Render]:
    """The states of one watcher until the stream is over; `to_the_end`: or until a render has ended."""
    while (render := await watcher.next()) is not None:
        yield render
        if to_the_end and render.has_ended:
            return
