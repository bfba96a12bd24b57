"""The mark `every_sixth`: `make test` takes a sixth of a test's cases, `make accuracy` all of them.

A test marked `soak`, too, runs all of them in `make soak`.
"""

from collections import Counter, defaultdict

import pytest

from tests.accuracy.tracing import IN_FULL


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselects the others; a case that is asked for by its name is run."""
    if IN_FULL:
        return
    tests: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("every_sixth") and not item.get_closest_marker("soak"):
            tests[item.nodeid.partition("[")[0]].append(item)
    left_out = {case for cases in tests.values() for case in set(cases).difference(_chosen(cases))}
    items[:] = [item for item in items if item not in left_out]
    config.hook.pytest_deselected(items=list(left_out))


def _chosen(cases: list[pytest.Item]) -> list[pytest.Item]:
    """Every sixth, and the first with a value that several cases share and none of these has.

    Of two cases both are run, as they are mostly two methods for one quantity.
    """
    if len(cases) < 3:
        return cases
    values = {case: _values(case) for case in cases}
    counts = Counter(value for each in values.values() for value in each)
    chosen = cases[::6]
    seen = {value for case in chosen for value in values[case]}
    for case in cases:
        if any(counts[value] > 1 and value not in seen for value in values[case]):
            chosen.append(case)
            seen |= values[case]
    return chosen


def _values(case: pytest.Item) -> set[tuple[str, str]]:
    """Of its parameters, each with its name."""
    parameters = (
        case.callspec.params if isinstance(case, pytest.Function) and hasattr(case, "callspec") else {}
    )
    return {(name, repr(value)) for name, value in parameters.items()}
