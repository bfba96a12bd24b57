"""A plugin of pytest: processor time of each test with all that it starts, the heaviest first.

`make heaviest` loads it. Counted are user and system time of the process that runs the test, and of its
children that have ended. So what a module's fixture starts counts for the module's last test; the list of
files has it right. Children of a program that was killed are not seen.
"""

import os
import resource
import tempfile
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path

import pytest

_FILE = "NOCTURNE_CPU_TIMES"
_SHOWN_TESTS = 60
_SHOWN_FILES = 40


def pytest_configure(config: pytest.Config) -> None:
    """The processes of xdist inherit the file to which each of them adds lines."""
    if _FILE not in os.environ:
        handle, name = tempfile.mkstemp(prefix="nocturne-cpu-times-")
        os.close(handle)
        os.environ[_FILE] = name
        config.add_cleanup(lambda: Path(name).unlink())


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
    _add("(collecting)", _seconds())
    return result


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Both lists."""
    tests: dict[str, float] = defaultdict(float)
    for line in Path(os.environ[_FILE]).read_text().splitlines():
        seconds, name = line.split(" ", 1)
        tests[name] += float(seconds)
    files: dict[str, float] = defaultdict(float)
    for name, used in tests.items():
        files[name.partition("::")[0]] += used
    for title, times, shown in (("files", files, _SHOWN_FILES), ("tests", tests, _SHOWN_TESTS)):
        terminalreporter.section(f"{sum(times.values()):.0f} s of processor time in {len(times)} {title}")
        for name in sorted(times, key=times.__getitem__, reverse=True)[:shown]:
            terminalreporter.write_line(f"{times[name]:6.1f}  {name}")


def _seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def _add(name: str, seconds: float) -> None:
    with Path(os.environ[_FILE]).open("a") as file:
        file.write(f"{seconds:.3f} {name}\n")
