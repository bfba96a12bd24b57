"""Changes as server-sent events: `event: render`, data a Render, id its sequence.

Checks that can refuse a stream are dependencies: they end before the first byte, so the answer has its
status."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, Header, Query, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent
from nocturne_scene.errors import InputError, NocturneError

from nocturne_api.limits import RENDERS_PER_STREAM
from nocturne_api.models.renders import TilesEvent
from nocturne_api.operations.render_streams import States
from nocturne_api.rest.requests import Service

router = APIRouter(prefix="/v1", tags=["events"])

_LONGEST_ID = 18
"""Digits: a number of 64 bits."""
_BEGUN = ServerSentEvent(comment="watching")
"""Sent at once: some proxies hold an answer back until it has a body."""


async def _states_of_one(
    render_id: str, operations: Service, response: Response, last_event_id: Annotated[str, Header()] = ""
) -> AsyncIterator[States]:
    known = -1
    if last_event_id.isascii() and last_event_id.isdecimal():
        if len(last_event_id) > _LONGEST_ID:
            raise InputError.at("header.Last-Event-ID", f"expected at most {_LONGEST_ID} digits")
        known = int(last_event_id)
    render = await operations.renders.get(render_id)
    if render.has_ended and render.sequence <= known:
        response.status_code = 204
    async with operations.streams.one(render_id, known) as states:
        yield states


@router.get("/renders/{render_id}/events", response_class=EventSourceResponse)
async def render_events(
    states: Annotated[States, Depends(_states_of_one)], response: Response
) -> AsyncIterator[ServerSentEvent]:
    """The render now and after every change; the stream ends after the final state.

    With Last-Event-ID only states after it are sent. If that was the final one the answer is 204, which tells
    a browser to stop asking.
    """
    if response.status_code == 204:
        return
    yield _BEGUN
    try:
        async for render in states:
            yield ServerSentEvent(event="render", data=render, id=str(render.sequence))
    except NocturneError as error:
        yield _too_late(error)


async def _states_of_many(
    operations: Service,
    render: Annotated[list[str] | None, Query(description="Only these, with their tiles.")] = None,
) -> AsyncIterator[States]:
    if len(render or ()) > RENDERS_PER_STREAM:
        raise InputError.at("query.render", f"at most {RENDERS_PER_STREAM} in one stream")
    stream = operations.streams.some(frozenset(render)) if render else operations.streams.newest()
    async with stream as states:
        yield states


@router.get("/events", response_class=EventSourceResponse)
async def all_events(
    states: Annotated[States, Depends(_states_of_many)],
    operations: Service,
    render: Annotated[list[str] | None, Query()] = None,
) -> AsyncIterator[ServerSentEvent]:
    """The newest 200 renders, then each of them after every change.

    With `render`, at most four times, only those, also after their ends; each change is followed by an event
    `tiles` that names the tiles with new samples, where there are any.
    """
    yield _BEGUN
    sequences: dict[str, int] = {}
    try:
        async for state in states:
            yield ServerSentEvent(event="render", data=state)
            if not render:
                continue
            # Samples committed since this state was read come with the next.
            since = sequences.get(state.id, 0)
            tiles = await operations.images.changed_tiles(state.id, since, state.sequence)
            sequences[state.id] = state.sequence
            if tiles:
                data = TilesEvent(render=state.id, revision=state.sequence, tiles=tiles)
                yield ServerSentEvent(event="tiles", data=data)
    except NocturneError as error:
        yield _too_late(error)


def _too_late(error: NocturneError) -> ServerSentEvent:
    """An error as a comment: the answer has begun, so it can't be a problem document."""
    return ServerSentEvent(comment=str(error))
