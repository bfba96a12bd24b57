"""`python -m bench.suite`: error against CPU time, scene by scene; writes speed.md and accuracy.md."""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from nocturne_client.errors import NocturneClientError

from bench.machine import load_average, processor
from bench.report import Figures, results_folder
from bench.suite import page
from bench.suite.measure import FULL, MINUTES, QUICK, measure, peer
from bench.suite.references import make
from bench.suite.scenes import SCENES


def main() -> int:
    """The exit code is 1 where a reference is missing or a program fails."""
    parser = argparse.ArgumentParser(prog="python -m bench.suite", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(SCENES)}; all by default")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--full", action="store_true", help="longer budgets, three rounds: hours")
    how.add_argument("--quick", action="store_true", help="to see that it works; not kept")
    how.add_argument("--references", action="store_true", help="make references instead of using them")
    how.add_argument("--pages", action="store_true", help="make the pages of what is kept")
    parser.add_argument(
        "--cpu-seconds", type=float, default=24.0, help="of a reference (default: %(default)g)"
    )
    parser.add_argument("--no-peer", action="store_true", help="without Mitsuba")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.scenes) - set(SCENES))
    if unknown:
        parser.error(f"no scene {', '.join(unknown)}; expected one of {', '.join(SCENES)}")
    try:
        if arguments.references:
            _references(arguments.scenes or list(SCENES), arguments.cpu_seconds)
        elif arguments.pages:
            page.write_pages(_kept())
        else:
            _measure(arguments)
    except NocturneClientError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    return 0


def _references(names: list[str], cpu_s: float) -> None:
    for name in names:
        with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
            make(name, SCENES[name], Path(folder), cpu_s)


def _measure(arguments: argparse.Namespace) -> None:
    size = QUICK if arguments.quick else FULL if arguments.full else MINUTES
    installed = None if arguments.no_peer else peer()
    for name in arguments.scenes or SCENES:
        print(f"bench: suite: {name}", file=sys.stderr)
        before = load_average()
        found: Figures = {
            "machine": processor(),
            "budgets_cpu_s": list(size.budgets_cpu_s),
            "rounds": size.rounds,
            **measure(name, SCENES[name], size, installed),
            "load_average": [before, load_average()],
        }
        print(json.dumps({"bench": "suite", "scene": name, **found}), flush=True)
        if not arguments.quick:
            _keep(name, found)
    if not arguments.quick:
        page.write_pages(_kept())


def _keep(name: str, found: Figures) -> None:
    """Replaces this scene's figures; others' stay."""
    scenes = {**_kept(), name: found}
    ordered = {each: scenes[each] for each in SCENES if each in scenes}
    _path().write_text(json.dumps(ordered, indent=1) + "\n")


def _kept() -> Figures:
    kept: Figures = json.loads(_path().read_text()) if _path().exists() else {}
    return kept


def _path() -> Path:
    return results_folder() / "suite.json"


if __name__ == "__main__":
    sys.exit(main())
