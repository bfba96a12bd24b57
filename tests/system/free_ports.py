"""Ports for a service that is started here."""

import random
import socket

# Below those that the kernel gives to whoever connects: none is lost between here and the service's start.
_LOWEST, _HIGHEST = 16_384, 32_000


def free_port_pair() -> int:
    """A port that is free now, and the one above it too."""
    # Not the shared generator, which a test may have seeded as another process's test has.
    chance = random.SystemRandom()
    while True:
        port = chance.randrange(_LOWEST, _HIGHEST, 2)
        with socket.socket() as first, socket.socket() as second:
            try:
                first.bind(("127.0.0.1", port))
                second.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port
