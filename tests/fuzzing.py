"""How many examples wild input is tried with: a few in every run, always the same; many in `make fuzz`."""

import os

from hypothesis import HealthCheck, settings

_ASKED = os.environ.get("NOCTURNE_FUZZ_EXAMPLES")


def tried(examples: int) -> settings:
    """So many of each kind, or as many as `make fuzz` asks for."""
    return settings(
        max_examples=int(_ASKED or examples),
        derandomize=_ASKED is None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )


def seeds(count: int) -> range:
    """So many, or as many as `make fuzz` asks for."""
    return range(int(_ASKED or count))
