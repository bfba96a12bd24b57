"""A process that gets a signal stops, whatever it does just then."""

import subprocess
import sys

_IN_THE_MIDST_OF_WAITING = """
import signal, threading
from nocturne_coordinator.signals import on_signals

stop = threading.Event()
on_signals({signal.SIGTERM: stop.set})
# What Event.wait holds for some microseconds.
with stop._cond:
    signal.raise_signal(signal.SIGTERM)
assert stop.wait(10)
# One that nothing was said about is not the thread's.
signal.signal(signal.SIGHUP, lambda *_: None)
stop.clear()
signal.raise_signal(signal.SIGHUP)
assert not stop.wait(0.2)
signal.raise_signal(signal.SIGTERM)
assert stop.wait(10)
"""


def test_a_signal_in_the_midst_of_waiting_for_it_is_noticed() -> None:
    """With a handler that sets the event, as `nocturne up` and the coordinator had, this never returns."""
    subprocess.run([sys.executable, "-c", _IN_THE_MIDST_OF_WAITING], check=True, timeout=60)
