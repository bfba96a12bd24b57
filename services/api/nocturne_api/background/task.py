"""Work of an API process other than its calls."""

import asyncio
from abc import ABC, abstractmethod
from contextlib import suppress


class Background(ABC):
    """Runs from `start` until it is closed; work in hand is cut off then."""

    _task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begins with what an earlier process left."""
        self._task = asyncio.create_task(self._run())

    async def close(self) -> None:
        if self._task is not None:
            self._task.cancel()
            with suppress(asyncio.CancelledError):
                await self._task

    @abstractmethod
    async def _run(self) -> None:
        """For ever."""
