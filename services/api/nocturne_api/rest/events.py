"""Changes as server-sent events: `event: render`, data a Render, id its sequence."""

import asyncio
import json
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable
from typing import Annotated

from fastapi import APIRouter, Header, Query
from nocturne_scene.errors import InputError, NocturneError
from starlette.responses import Response, StreamingResponse

from nocturne_api.limits import KEEP_ALIVE_S, RENDERS_PER_STREAM
from nocturne_api.operations import Operations
from nocturne_api.rest.access import Service
from nocturne_api.views import RenderView

router = APIRouter(prefix="/v1", tags=["events"])

_HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}


class EventStream(StreamingResponse):
    """A response of server-sent events."""

    media_type = "text/event-stream"


@router.get("/renders/{render_id}/events", response_class=EventStream)
async def render_events(
    render_id: str, operations: Service, last_event_id: Annotated[str, Header()] = ""
) -> Response:
    """The render now and after every change; the stream ends after the final state.

    With Last-Event-ID only states after it are sent. If that was the final one the answer is 204, which tells
    a browser to stop asking.
    """
    known = int(last_event_id) if last_event_id.isascii() and last_event_id.isdecimal() else -1
    render = await operations.get_render(render_id)
    if render.has_ended and render.sequence <= known:
        return Response(status_code=204)
    return EventStream(_events(operations.watch_render(render_id, known), _numbered), headers=_HEADERS)


@router.get("/events", response_class=EventStream)
async def all_events(
    operations: Service,
    render: Annotated[list[str] | None, Query(description="Only these, with their tiles.")] = None,
) -> Response:
    """The newest 200 renders, then each of them after every change.

    With `render`, at most four times, only those, also after their ends; each change is followed by an event
    `tiles` that names the tiles with new samples, where there are any.
    """
    if not render:
        return EventStream(_events(operations.watch_all(), _plain), headers=_HEADERS)
    if len(render) > RENDERS_PER_STREAM:
        raise InputError.at("query.render", f"at most {RENDERS_PER_STREAM} in one stream")
    for render_id in render:
        await operations.get_render(render_id)
    states = operations.watch_some(frozenset(render))
    return EventStream(_events(states, _WithTiles(operations)), headers=_HEADERS)


class _WithTiles:
    """A state as an event, and another one for the tiles that changed with it."""

    def __init__(self, operations: Operations) -> None:
        self._operations = operations
        self._known: dict[str, int] = {}

    async def __call__(self, render: RenderView) -> str:
        since = self._known.get(render.id, 0)
        self._known[render.id] = render.sequence
        tiles = await self._operations.changed_tiles(render.id, since)
        text = await _plain(render)
        if not tiles:
            return text
        data = {"render": render.id, "revision": render.sequence, "tiles": tiles}
        return f"{text}event: tiles\ndata: {json.dumps(data)}\n\n"


async def _plain(render: RenderView) -> str:
    return f"event: render\ndata: {render.model_dump_json()}\n\n"


async def _numbered(render: RenderView) -> str:
    return f"id: {render.sequence}\n{await _plain(render)}"


async def _events(
    states: AsyncGenerator[RenderView, None], event: Callable[[RenderView], Awaitable[str]]
) -> AsyncIterator[str]:
    """`states` as events, with a comment whenever nothing was sent for KEEP_ALIVE_S."""
    waiting: asyncio.Future[RenderView] | None = None
    try:
        yield ": watching\n\n"
        while True:
            waiting = waiting or asyncio.ensure_future(anext(states))
            done, _ = await asyncio.wait({waiting}, timeout=KEEP_ALIVE_S)
            if not done:
                yield ": still here\n\n"
                continue
            try:
                render = waiting.result()
            except StopAsyncIteration:
                return
            except NocturneError as error:  # Too late for a problem document: the answer has begun.
                yield f": {error}\n\n"
                return
            waiting = None
            yield await event(render)
    finally:
        if waiting is not None:
            waiting.cancel()
            await asyncio.wait({waiting})
        await states.aclose()
