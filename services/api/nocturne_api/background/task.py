"""What an API process does beside its calls."""

import asyncio
from abc import ABC, abstractmethod
from contextlib import suppress


class Background(ABC):
    """Runs from `start` until it is closed; what it is at then is cut off."""

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
