"""`python -m tests.crossings`: random scenes by methods that share little; see docs/how-to/tests.md."""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from tests.crossings import totals
from tests.crossings.campaign import Campaign, run, told
from tests.crossings.judging import holm
from tests.crossings.looking import SAMPLES, Outcome
from tests.crossings.smallest import smallest
from tests.crossings.totals import RESULTS

_REDUCE_SECONDS = 180.0
_WORST_PAIRS = 20
_PILOTS = 4
"""One scene of so many is traced as a pilot chooses, too."""
_WORTH_KEEPING = 50
"""Scenes; fewer are for a look at one that failed."""
_SEEDS_TOLD = 50


def main() -> int:
    """Exit code 1 where there are faults."""
    parser = argparse.ArgumentParser(prog="python -m tests.crossings", description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed of the first scene")
    parser.add_argument("--scenes", type=int, default=1000, help="how many")
    parser.add_argument("--minutes", type=float, default=60.0, help="no further scene begins after that")
    parser.add_argument(
        "--samples", type=int, default=SAMPLES, help="of a pixel by one seed, at the first look"
    )
    parser.add_argument(
        "--results", type=Path, default=RESULTS, help="folder of what this and other runs found"
    )
    parser.add_argument("--into", type=Path, default=Path("build/crossings"), help="folder of reduced scenes")
    parser.add_argument("--keep-whole", action="store_true", help="do not reduce scenes that fail")
    asked = parser.parse_args()
    seeds = range(asked.first, asked.first + asked.scenes)
    with tempfile.TemporaryDirectory(prefix="nocturne-crossings-") as folder:
        found = run(seeds, Path(folder), 60.0 * asked.minutes, _tell, asked.samples, _PILOTS)
        _say(found.summary())
        _print_pairs(found)
        if len(found.outcomes) >= _WORTH_KEEPING:
            totals.write(totals.run_of(found, asked.first, asked.samples), asked.results)
            _say(totals.summary(totals.read(asked.results)))
        for fault in found.faults:
            _say(told(fault))
            if not asked.keep_whole:
                _write_smallest(fault, Path(folder), asked.into)
    return 1 if found.faults else 0


def _tell(outcome: Outcome) -> None:
    """While it goes on."""
    if outcome.scene.seed % _SEEDS_TOLD == 0:
        sys.stderr.write(f"at seed {outcome.scene.seed}\n")
    if outcome.broken or holm([outcome.probability])[0]:
        sys.stderr.write(f"{told(outcome)}\n")


def _print_pairs(found: Campaign) -> None:
    kinds = sorted({name for pair in found.pairs for name in pair})
    seldom = sorted(
        ((one, other) for index, one in enumerate(kinds) for other in kinds[index + 1 :]),
        key=lambda pair: found.pairs[pair],
    )
    shown = [f"{one} with {other} ({found.pairs[one, other]})" for one, other in seldom[:_WORST_PAIRS]]
    _say(f"pairs that met least: {', '.join(shown)}")


def _write_smallest(fault: Outcome, folder: Path, into: Path) -> None:
    document = smallest(fault, folder, _REDUCE_SECONDS)
    into.mkdir(parents=True, exist_ok=True)
    file = into / f"crossing-{fault.scene.seed}.json"
    file.write_text(json.dumps(document, indent=1))
    _say(f"  reduced: {file}\n  {json.dumps(document)}")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
