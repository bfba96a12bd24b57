"""All orders in which jobs, results, commits, crashes and takeovers can happen, on the real coordinator.

A crash is that of a worker, of a coordinator, or of Redis with all that is in it; in a takeover a coordinator
goes on that does not know that it lost its lease. In every state the sums are those of the first ranges in
order, each once, commits never go back, and the render can be finished. See `explorer.py`.
"""

import pytest

from tests.faults.cores import WentWrong
from tests.faults.explorer import Explorer


@pytest.mark.parametrize(
    ("ranges", "workers", "crashes", "takeovers", "states"),
    [
        (3, 2, 0, 0, 549),
        (3, 1, 1, 0, 1_286),
        pytest.param(3, 2, 1, 0, 60_763, marks=pytest.mark.soak),
        (3, 1, 2, 0, 11_870),
        (2, 2, 2, 0, 17_638),
        (2, 1, 0, 1, 2_120),
        pytest.param(2, 1, 1, 1, 28_814, marks=pytest.mark.soak),
        (3, 1, 0, 1, 28_813),
    ],
)
def test_no_order_of_things_counts_a_range_twice_or_never(
    ranges: int, workers: int, crashes: int, takeovers: int, states: int
) -> None:
    """S4: the numbers of states are checked, so that no change shortens the search by mistake."""
    assert Explorer(ranges, workers, crashes, takeovers).walk() == states


@pytest.mark.parametrize(
    ("ranges", "workers", "crashes", "takeovers", "copies", "states"),
    [
        (3, 2, 0, 0, 1, 21_296),
        pytest.param(3, 2, 0, 0, 2, 335_349, marks=pytest.mark.soak),
        (2, 1, 1, 0, 2, 11_643),
        pytest.param(2, 1, 0, 1, 1, 49_729, marks=pytest.mark.soak),
        pytest.param(2, 2, 1, 0, 1, 62_119, marks=pytest.mark.soak),
    ],
)
def test_nor_where_jobs_have_quick_copies_that_may_be_stopped(
    ranges: int, workers: int, crashes: int, takeovers: int, copies: int, states: int
) -> None:
    """S4: a quick copy is done, or stopped, before its job or after, by anybody."""
    assert Explorer(ranges, workers, crashes, takeovers, copies=copies).walk() == states


def test_without_fences_the_walk_finds_what_they_are_for() -> None:
    with pytest.raises(WentWrong, match="less committed"):
        Explorer(3, 1, 0, takeovers=1, fenced=False).walk()
