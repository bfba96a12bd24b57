"""How a render is taken up, or goes on by another schedule: in steps, as a large film has 65,536 tiles, and
nobody waits for all of them. Pure."""

from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from nocturne_coordinator.dispatch import film
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.records import OpenRender, TileRow
from nocturne_coordinator.dispatch.running_render import RunningRender

TILES_AT_ONCE = 256
"""That are read before others get their turn: 20 MB."""


class Loading(NamedTuple):
    """A render that is being taken up, or goes on by another schedule."""

    render: RunningRender
    steps: Iterator[list[RangeQueue] | None]
    """The rest of it in steps, between which others get their turn; the last one gives its ranges."""
    is_replanned: bool = False
    """It was at work here a moment ago."""


def steps_of(render: RunningRender, tiles: Iterator[TileRow]) -> Iterator[list[RangeQueue] | None]:
    """Of a render that was made without tiles; `tiles`: the committed ones."""
    for _ in render.building():
        yield None
    while render.load(islice(tiles, TILES_AT_ONCE)) == TILES_AT_ONCE:
        yield None
    for _ in render.loading():
        yield None
    yield from _ranges_of(render)


def steps_of_other_plan(render: RunningRender, row: OpenRender) -> Iterator[list[RangeQueue] | None]:
    """Of a render that is set aside, and goes on as the row says."""
    for _ in render.replanning(row):
        yield None
    yield from _ranges_of(render)


def _ranges_of(render: RunningRender) -> Iterator[list[RangeQueue] | None]:
    found: list[RangeQueue] = []
    following = render.each_range_queue()
    while part := list(islice(following, film.QUEUES_AT_ONCE)):
        found += part
        if len(part) == film.QUEUES_AT_ONCE:
            yield None
    yield found
