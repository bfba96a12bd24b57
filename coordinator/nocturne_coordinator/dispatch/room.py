"""How many renders, and how large films, are at work at once, and their shares of the workers. Pure."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.film_memory import max_numbers, numbers_of
from nocturne_coordinator.dispatch.records import OpenRender, RenderState
from nocturne_coordinator.dispatch.running_render import RunningRender


class Room:
    """That a coordinator has."""

    def __init__(self, memory_bytes: int) -> None:
        """0: unknown, and enough."""
        self._memory_bytes = memory_bytes

    def has(self, row: OpenRender, renders: Sequence[RunningRender], newcomer: bool) -> bool:
        """Whether there is room for one more next to these; `newcomer`: its owner has none at work."""
        if len(renders) >= limits.MAX_RUNNING + (limits.MAX_NEWCOMERS if newcomer else 0):
            return False
        wanted, most = numbers_of(row.schedule), max_numbers(self._memory_bytes)
        if wanted > most:
            # One at a time, which takes nothing of the others' room.
            return all(numbers_of(render.row.schedule) <= most for render in renders)
        held: Counter[str] = Counter()
        for render in renders:
            if (numbers := numbers_of(render.row.schedule)) <= most:
                held[render.row.owner] += numbers
        free_for_owner = 2 * most - (held.total() - held[row.owner])
        return held[row.owner] + wanted <= free_for_owner / 2


def is_at_work(row: OpenRender) -> bool:
    return row.state is RenderState.RUNNING and row.holder != 0


def share_of(ours: Mapping[str, RunningRender], rows: Iterable[OpenRender]) -> float:
    """What our renders should get of the workers: owners by their weight, an owner's renders by priority."""
    working = [row for row in rows if row.holder or row.id in ours]
    priorities: Counter[str] = Counter()
    for row in working:
        priorities[row.owner] += row.priority
    parts = {row.id: row.owner_weight * row.priority / priorities[row.owner] for row in working}
    whole = sum(parts.values())
    return sum(part for render_id, part in parts.items() if render_id in ours) / whole if whole else 1.0
