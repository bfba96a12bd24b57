"""Time, given to all that needs it, so that tests can tell it."""

import random
import threading
import time

from nocturne_coordinator.dispatch.events import Moment


class Clock:
    """The machine's clocks."""

    def __init__(self, stop: threading.Event | None = None) -> None:
        self._stop = stop or threading.Event()
        self._chance = random.SystemRandom()

    def moment(self) -> Moment:
        return Moment(time.monotonic(), time.time())

    def wait(self, seconds: float) -> None:
        """Until then, or until the process is to stop."""
        self._stop.wait(max(0.0, seconds))

    @property
    def stopping(self) -> bool:
        return self._stop.is_set()

    def random(self) -> float:
        """At random in [0, 1), not to be foreseen."""
        return self._chance.random()
