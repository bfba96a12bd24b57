"""Processor time of each test with all that it starts: a plugin of pytest, and a list of the heaviest.

The plugin adds lines to the file that NOCTURNE_CPU_TIMES names. Counted are user and system time of the
process that runs the test, and of its children that have ended. So what a module's fixture starts counts for
the module's last test; the list of files has it right. Children of a program that was killed are not seen.
"""

import os
import resource
import sys
from collections import defaultdict
from collections.abc import Generator, Mapping
from pathlib import Path

import pytest

_COLLECTING = "(collecting)"

COSTLY_S = 2.0
"""What a test of `make test` may take without a good reason: docs/how-to/tests.md."""


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Setup, test and teardown."""
    before = _seconds()
    result = yield
    _add(item.nodeid, _seconds() - before)
    return result


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Of each process, with the imports of all tests."""
    result = yield
    _add(_COLLECTING, _seconds())
    return result


def _seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _add(name: str, seconds: float) -> None:
    with Path(os.environ["NOCTURNE_CPU_TIMES"]).open("a") as file:
        file.write(f"{seconds:.3f} {name}\n")


def report(lines: list[str], files: int, tests: int) -> str:
    """The sum, so many of the heaviest files, and so many tests, or those over COSTLY_S if that is fewer."""
    by_test: dict[str, float] = defaultdict(float)
    for line in lines:
        seconds, name = line.split(" ", 1)
        by_test[name] += float(seconds)
    by_file: dict[str, float] = defaultdict(float)
    for name, used in by_test.items():
        by_file[name.partition("::")[0]] += used
    costly = {name: used for name, used in by_test.items() if used > COSTLY_S and name != _COLLECTING}
    return "\n".join(
        [
            f"{sum(by_test.values()):.0f} s of processor time in {len(by_test)} tests in Python",
            *_heaviest(by_file, files),
            f"{len(costly)} tests take more than {COSTLY_S:g} s",
            *_heaviest(costly, tests),
        ]
    )


def _heaviest(times: Mapping[str, float], shown: int) -> list[str]:
    names = sorted(times, key=times.__getitem__, reverse=True)[:shown]
    return [f"{times[name]:6.1f}  {name}" for name in names]


def main() -> None:
    """FILE FILES TESTS."""
    lines = Path(sys.argv[1]).read_text().splitlines()
    sys.stdout.write(report(lines, *map(int, sys.argv[2:4])) + "\n")


if __name__ == "__main__":
    main()
