"""Whose scene is compiled next: no owner's scenes wait for those of others to be compiled."""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from nocturne_api.limits import COMPILES_AT_ONCE, COMPILES_OF_NEWCOMERS


class CompileTurns:
    """Some scenes at once, whoever's they are; and beyond those, one of each owner who has none."""

    def __init__(self) -> None:
        self._at_work: Counter[str] = Counter()
        self._waiting: list[tuple[str, asyncio.Future[None]]] = []

    @asynccontextmanager
    async def turn(self, owner: str) -> AsyncIterator[None]:
        """Waits for a turn of an owner's, and has it for as long as the context lasts."""
        came: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append((owner, came))
        self._give_turns()
        try:
            await came
            yield
        finally:
            if (owner, came) in self._waiting:
                self._waiting.remove((owner, came))
            else:
                self._at_work[owner] -= 1
                self._at_work += Counter()
            self._give_turns()

    def _give_turns(self) -> None:
        # The owner with fewest at work first, and of equal ones who came first.
        for owner, came in sorted(self._waiting, key=lambda each: self._at_work[each[0]]):
            newcomers = 0 if self._at_work[owner] else COMPILES_OF_NEWCOMERS
            if self._at_work.total() < COMPILES_AT_ONCE + newcomers:
                self._waiting.remove((owner, came))
                self._at_work[owner] += 1
                if not came.done():
                    came.set_result(None)
