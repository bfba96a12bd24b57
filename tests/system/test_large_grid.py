"""A grid of half a gigabyte through upload, compiler, cache and workers."""

import pytest

from bench import grid

pytestmark = [pytest.mark.system, pytest.mark.soak]

_API_BYTES = 250_000_000
"""Half of the file: the API's memory does not grow with an asset."""


def test_half_a_gigabyte_is_held_once_by_each_worker_and_never_by_the_service() -> None:
    figures = grid.run(quick=False)
    size, most = figures["grid_bytes"], figures["most_bytes"]
    assert size > 500_000_000
    # One copy in the cache for both; the scene itself is small.
    assert figures["cache_bytes"] < size + 1_000_000
    workers = [most[f"worker-{number}"] for number in range(1, grid.WORKERS + 1)]
    # Both have it: neither traced alone.
    assert all(size < bytes_ < grid.MAX_OF_GRID * size for bytes_ in workers)
    service = ("nocturne_api", "nocturne_api.compiling.server", "nocturne_coordinator", "redis-server")
    assert all(0 < most[name] < _API_BYTES for name in service)
    # As OpenVDB's tree and as NanoVDB's, side by side.
    assert most["nocturne-grid"] < 2.5 * size
