"""Stops by error, by simulation: an image that ended at 5 % is rarely off by more than 10 %."""

import pytest

from bench.stops import MAX_WRONG_SHARE, SCENES, rows, run, wrong_share
from tests.accuracy.tracing import IN_FULL


@pytest.mark.skipif(not IN_FULL, reason="4,000 renders, in `make accuracy`")
def test_honest_stops_are_rarely_wrong() -> None:
    """Ten renders of each of twenty scenes. The estimate alone, which it once was, is wrong too often: so
    the scenes are such that the rules matter."""
    figures = run(quick=True)
    assert len(SCENES) == 20
    assert wrong_share(figures, "rules") < MAX_WRONG_SHARE
    assert wrong_share(figures, "estimate alone") > MAX_WRONG_SHARE
    # They do end where light is even, lamps in the picture and black backgrounds included.
    for name in ("even noise", "exponential", "a lamp in the picture", "a disc before black"):
        assert figures[name]["rules"]["ended"] == figures["renders"]
    assert len(rows(figures)) == len(SCENES) + 1
