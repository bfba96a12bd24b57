"""How many renders, and how large films, are at work at once, and what they get of the workers. Pure."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from nocturne_scene.tile_sums import sums_per_pixel

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.records import OpenRender, RenderState
from nocturne_coordinator.dispatch.running_render import RunningRender

_NUMBER_BYTES = 8


class Room:
    """That a coordinator has."""

    def __init__(self, memory_bytes: int) -> None:
        """0: unknown, and enough."""
        self._memory_bytes = memory_bytes

    def has(self, row: OpenRender, renders: Sequence[RunningRender], newcomer: bool) -> bool:
        """Whether there is room for one more beside these; `newcomer`: its owner has none at work."""
        if len(renders) >= limits.MAX_RUNNING + (limits.MAX_NEWCOMERS if newcomer else 0):
            return False
        wanted, most = _numbers_of(row), self._most_numbers
        if wanted > most:
            # One at a time, which takes nothing of the others' room.
            return all(_numbers_of(render.row) <= most for render in renders)
        held: Counter[str] = Counter()
        for render in renders:
            if (numbers := _numbers_of(render.row)) <= most:
                held[render.row.owner] += numbers
        free_for_owner = 2 * most - (held.total() - held[row.owner])
        return held[row.owner] + wanted <= free_for_owner / 2

    @property
    def _most_numbers(self) -> int:
        """That an owner's renders may hold where nobody else is."""
        memory = self._memory_bytes
        of_memory = int(limits.SUMS_PART_OF_MEMORY * memory / _NUMBER_BYTES / 2)
        return min(limits.MAX_RUNNING_SUMS, of_memory) if memory else limits.MAX_RUNNING_SUMS

    def too_large(self, row: OpenRender) -> str:
        """Why a film can never be held, with what makes its pictures; empty: it can."""
        memory = self._memory_bytes
        pixels = row.schedule.width * row.schedule.height
        needed = 2 * _NUMBER_BYTES * _numbers_of(row) + limits.PICTURE_BYTES * pixels + limits.MEMORY_BESIDE
        if not memory or needed <= memory:
            return ""
        return (
            f"A film of {row.schedule.width} x {row.schedule.height} needs {needed / 2**30:.1f} GiB of "
            f"memory where the coordinator runs, and there are {memory / 2**30:.1f} GiB: render a smaller "
            "one, or give the coordinator more."
        )


def _numbers_of(row: OpenRender) -> int:
    """That a render's sums have: its film's, and with forward photons theirs and those of both together."""
    per_pixel = sums_per_pixel(len(row.schedule.further_responses))
    films = 3 if row.schedule.photon_range_ends else 1
    return films * row.schedule.width * row.schedule.height * per_pixel


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
