"""Watchers of changes: one poller per process, any number of watchers, each holding newest states only.

A watcher that reads slowly skips states, never queues them: it waits on a slot per render that every
change overwrites. The poller runs only while somebody watches.
"""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Iterable, Iterator, Sequence, Set
from contextlib import contextmanager, suppress
from typing import Protocol

from nocturne_api.access import Caller
from nocturne_api.errors import Overloaded, Unauthenticated
from nocturne_api.limits import WATCH_INTERVAL_S, WATCH_REST, WATCHERS, WATCHERS_OF_OWNER
from nocturne_api.models.renders import Render

_log = logging.getLogger(__name__)


class Watcher:
    """The newest unread state of each render that one caller watches."""

    def __init__(self, render_ids: frozenset[str] | None, caller: Caller) -> None:
        """`render_ids`: None for the newest that the caller may see."""
        self.render_ids = render_ids
        self.caller = caller
        self._newest: dict[str, Render] = {}
        self._sent: dict[str, int] = {}
        self._awake = asyncio.Event()
        self._closed = False
        self._why: Exception | None = None

    def offer(self, render: Render) -> None:
        """Takes a state, unless this watcher has seen it or one after it, or was shut."""
        if self._why is None and render.sequence > self._sent.get(render.id, -1):
            self._newest[render.id] = render
            self._awake.set()

    def already_has(self, render_id: str, sequence: int) -> None:
        """Leaves out states up to `sequence`, which the caller knows from an earlier connection."""
        self._sent[render_id] = sequence

    def close(self) -> None:
        """Ends the stream after the states at hand."""
        self._closed = True
        self._awake.set()

    def shut(self, why: Exception) -> None:
        """Ends the stream with an error, before the states at hand."""
        self._why = why
        self._newest.clear()
        self.close()

    async def next(self) -> Render | None:
        """The next state, waiting for one; None when the stream is over. Raises the error that shut it."""
        while not self._newest:
            if self._why is not None:
                raise self._why
            if self._closed:
                return None
            self._awake.clear()
            await self._awake.wait()
        render_id = next(iter(self._newest))
        render = self._newest.pop(render_id)
        self._sent[render_id] = render.sequence
        return render

    def forget_except(self, render_ids: Iterable[str]) -> None:
        """Drops the states of renders that are no longer in sight, so that memory stays bounded."""
        kept = set(render_ids)
        self._sent = {key: value for key, value in self._sent.items() if key in kept}


class Source(Protocol):
    """Where states come from."""

    async def change_counter(self) -> int:
        """Cheap, and another whenever something changed."""

    async def get(self, render_id: str) -> Render | None:
        """One render, whoever may see it; None if it is gone."""

    async def newest(self, owner: str | None) -> list[Render]:
        """The newest page of an owner's renders, or of everybody's."""

    async def revoked(self, names: Set[str]) -> Set[str]:
        """Those of the tokens, by name, that were revoked."""


class Watchers:
    """All watchers of this process, and the task that feeds them."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._watchers: set[Watcher] = set()
        self._poller: asyncio.Task[None] | None = None
        self._closed = False

    @contextmanager
    def watching(self, render_ids: frozenset[str] | None, caller: Caller) -> Iterator[Watcher]:
        """A watcher of these renders, or where that is None of all that the caller sees; Overloaded."""
        if len(self._watchers) >= WATCHERS:
            raise Overloaded(f"{WATCHERS} watchers are connected to this service; close some and try again.")
        of_caller = sum(each.caller.name == caller.name for each in self._watchers)
        if caller.name and of_caller >= WATCHERS_OF_OWNER:
            raise Overloaded(
                f"{of_caller} watchers of {caller.name} are connected; close some and try again."
            )
        watcher = Watcher(render_ids, caller)
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
        seen: int | None = None
        told: int | None = None
        rests_until = 0.0
        try:
            while self._watchers:
                # A counter seen before the read: a change in between is read twice rather than lost.
                counter = await self._source.change_counter()
                begun = time.monotonic()
                if counter != told and begun >= rests_until:
                    await self._tell()
                    seen = told = counter
                    now = time.monotonic()
                    rests_until = now + WATCH_REST * (now - begun)
                elif counter != seen:
                    # Never put off: a slow disk would keep streams of revoked tokens open for that long.
                    await self._shut_out()
                    seen = counter
                await asyncio.sleep(WATCH_INTERVAL_S)
        except Exception:
            _log.exception("watching the data folder failed")
            for watcher in self._watchers:
                watcher.close()

    async def _shut_out(self) -> None:
        """Ends the streams of tokens that were revoked."""
        names = {each.caller.name for each in self._watchers} - {""}
        revoked = await self._source.revoked(names) if names else set()
        for watcher in [each for each in self._watchers if each.caller.name in revoked]:
            watcher.shut(Unauthenticated("the token was revoked"))

    async def _tell(self) -> None:
        """Reads states, then looks who was revoked, and only then notifies: nobody hears of later states."""
        render_ids = frozenset().union(*(each.render_ids or () for each in self._watchers))
        renders = {render_id: await self._source.get(render_id) for render_id in render_ids}
        owners = {each.caller.sees for each in self._watchers if each.render_ids is None}
        newest = {owner: await self._source.newest(owner) for owner in owners}
        await self._shut_out()
        for watcher in self._watchers:
            # Who came meanwhile read its first states itself, and hears of the next change.
            if watcher.render_ids is not None:
                for render_id in watcher.render_ids & renders.keys():
                    _offer(watcher, renders[render_id])
            elif watcher.caller.sees in newest:
                _offer_newest(watcher, newest[watcher.caller.sees])


def _offer(watcher: Watcher, render: Render | None) -> None:
    if render is None:
        watcher.close()
    else:
        watcher.offer(render)


def _offer_newest(watcher: Watcher, renders: Sequence[Render]) -> None:
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
