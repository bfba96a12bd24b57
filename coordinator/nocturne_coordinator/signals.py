"""Signals, acted on by a thread. A handler of Python runs between two steps of the main thread, which may
hold the very lock that the handler needs: in the midst of Event.wait its Event.set never returns."""

import os
import signal
import threading
from collections.abc import Callable, Mapping


def on_signals(actions: Mapping[signal.Signals, Callable[[], None]]) -> None:
    """From here on a thread calls one of these for each such signal. For the main thread, once in a
    process."""
    received, arriving = os.pipe()
    os.set_blocking(arriving, False)
    signal.set_wakeup_fd(arriving)
    for number in actions:
        # Without a handler the signal has its usual effect, and is not written.
        signal.signal(number, lambda *_: None)

    def act() -> None:
        while numbers := os.read(received, 1):
            if action := actions.get(signal.Signals(numbers[0])):
                action()

    threading.Thread(target=act, name="signals", daemon=True).start()
