"""Changes as server-sent events: `event: render`, data a Render, id its sequence."""

import asyncio
from collections.abc import AsyncGenerator, AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Header
from nocturne_coordinator.errors import NocturneError
from starlette.responses import Response, StreamingResponse

from nocturne_api.limits import KEEP_ALIVE_S
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
    return EventStream(_events(operations.watch_render(render_id, known)), headers=_HEADERS)


@router.get("/events", response_class=EventStream)
async def all_events(operations: Service) -> Response:
    """The newest 200 renders, then each of them after every change."""
    return EventStream(_events(operations.watch_all(), with_id=False), headers=_HEADERS)


async def _events(states: AsyncGenerator[RenderView, None], with_id: bool = True) -> AsyncIterator[str]:
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
            yield _event(render, with_id)
    finally:
        if waiting is not None:
            waiting.cancel()
            await asyncio.wait({waiting})
        await states.aclose()


def _event(render: RenderView, with_id: bool) -> str:
    name = f"id: {render.sequence}\n" if with_id else ""
    return f"{name}event: render\ndata: {render.model_dump_json()}\n\n"
