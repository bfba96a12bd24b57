"""A plugin: wherever a test starts a coordinator, another one works on the same folder.

    pytest -p tests.postgresql.everywhere -p tests.postgresql.two_coordinators tests/faults

The second takes what the first leaves behind, so a killed coordinator's renders go on before it is started
again. What is about one coordinator alone is left out, by name.
"""

from collections.abc import Iterator

import pytest

from tests.coordinator.service import Service
from tests.system.forked import Forked

_SHARED = ("--shared", "--lease-seconds", "1.0")

_CRASHES = "waits for its own coordinator to crash in mid-commit, and the other may have the render"
_OF_ONE_ALONE = {
    "test_coordinator_killed": _CRASHES,
    "test_a_killed_coordinator_is_replaced_at_once": _CRASHES,
    "test_coordinator_in_a_crash_loop": _CRASHES,
    "test_further_responses_come_through_a_restart": _CRASHES,
    "test_a_slow_merger_holds_the_workers_back": "slows one coordinator down; the other merges",
    "test_an_upgrade_in_mid_render": "stops its coordinator, and the other goes on by the engine that it has",
    "test_second_coordinator_is_refused": "about coordinators that do not share",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Says why each test that is left out is."""
    for item in items:
        for name, why in _OF_ONE_ALONE.items():
            if name in item.nodeid:
                item.add_marker(pytest.mark.skip(reason=why))


@pytest.fixture(scope="session", autouse=True)
def _with_another() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        start = Service.start

        def start_both(self: Service, crash_at: str = "", *options: str) -> Forked:
            """The test's own is the one that it may kill; what it kills, the other outlives."""
            has_one = any(each.poll() is None for each in self._others)
            first = start(self, crash_at, *_SHARED, *options)
            if not has_one:
                start(self, "", *_SHARED, *options)
                assert self._process is not None
                self._others[-1], self._process = self._process, first
            return first

        patch.setattr(Service, "start", start_both)
        yield
