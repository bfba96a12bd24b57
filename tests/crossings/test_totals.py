"""Several runs are judged as one."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.crossings.totals import Overlap, Run, read, summary, write

RUN = Run(29, 0, 1000, 32, 940, 1000, 9, {}, {}, 700.0, {"other": (-30.0, 100)})


def test_runs_add_up(tmp_path: Path) -> None:
    runs = [RUN, replace(RUN, first=1000, held=960, broken={"1007": "seed 1007: it ended"})]
    for each in (*runs, replace(RUN, engine=28)):
        write(each, tmp_path)
    assert read(tmp_path, 29) == runs
    told = summary(runs)
    assert "2 runs, 2000 scenes: 1 faults, seed 1007; " in told
    assert "95.00% of 2000 stated" in told
    assert "1400 CPU s" in told
    # -60 of 200 scenes: 4.2 standard deviations of a sum of so many.
    assert "beside plain: other -4.2" in told


def test_what_is_a_fault_alone_may_be_chance_among_many() -> None:
    """0.01 / 1000 is between the probability and 0.01 / 500."""
    one = replace(RUN, scenes=500, differ={"7": 1.5e-5})
    assert "1 faults, seed 7" in summary([one])
    assert "0 faults" in summary([one, replace(RUN, first=500, scenes=500)])


def test_scenes_count_once() -> None:
    with pytest.raises(Overlap, match="from 0 and 999 have scenes in common"):
        summary([RUN, replace(RUN, first=999)])
