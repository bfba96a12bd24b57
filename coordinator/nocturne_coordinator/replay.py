"""`python -m nocturne_coordinator.replay FILE`: a night once more, from its event log, by a fresh core.

Prints what happened, and checks after every event that the state is one that may be, and that the same
instructions follow as then. Exit code 1 where they differ: this program decides otherwise than the one that
wrote the log."""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from nocturne_coordinator.dispatch.core import Core
from nocturne_coordinator.dispatch.instructions import Log
from nocturne_coordinator.errors import QueueError
from nocturne_coordinator.event_log import TROUBLES, decoded, summary_of

Line = tuple[str, Any]


class ReplayMismatch(Exception):
    """Other instructions follow than then, or there is something else wrong with the log."""


def replay(lines: Iterator[Line], say: bool = False) -> tuple[int, int]:
    """Gives the numbers of events and of instructions; `say` prints what the core logged. ReplayMismatch."""
    first = next(lines, None)
    if first is None or first[0] != "head":
        raise ReplayMismatch("the first line is not that of an event log")
    head = first[1]
    core = Core(head["settings"])
    core.state.fleet.quarantined = head["quarantined"]
    ahead = _Lines(lines)
    events = instructions = 0
    while (line := ahead.next()) is not None:
        kind, event = line
        if kind == "full":
            break
        if kind != "event":
            raise ReplayMismatch(f"after event {events}: an event was expected, there is {kind} {event}")
        events += 1
        instructions += _one(core, event, events, ahead, say)
        core.validate_state()
    return events, instructions


def _one(core: Core, event: Any, number: int, ahead: "_Lines", say: bool) -> int:
    steps, count = core.handle(event), 0
    try:
        instruction = next(steps)
        while True:
            if ahead.is_over():
                # Killed, or full, in the middle of it.
                return count
            found = summary_of(instruction)
            kind, then = ahead.next() or ("", None)
            if kind != "did" or then != found:
                raise ReplayMismatch(f"event {number}, {type(event).__name__}: now {found[0]}, then {then}")
            count += 1
            if ahead.is_over():
                return count
            if say and isinstance(instruction, Log):
                print(f"{event.at.unix:.3f} {instruction.message}")  # noqa: T201
            kind, answer = ahead.answer()
            if kind == "trouble":
                instruction = steps.throw(TROUBLES[answer[0]](answer[1]))
            else:
                instruction = steps.send(answer)
    except (StopIteration, QueueError):
        return count


class _Lines:
    """The lines, with a look at the next one."""

    def __init__(self, lines: Iterator[Line]) -> None:
        self._lines = lines
        self._ahead = next(lines, None)

    def is_over(self) -> bool:
        return self._ahead is None or self._ahead[0] == "full"

    def next(self) -> Line | None:
        line, self._ahead = self._ahead, next(self._lines, None)
        return line

    def answer(self) -> Line:
        """The answer or the trouble that comes next; nothing is an answer, too."""
        if self._ahead is not None and self._ahead[0] in ("answer", "trouble"):
            return self.next() or ("answer", None)
        return "answer", None


def read_lines(path: Path) -> Iterator[Line]:
    """A log's lines; the last one may be cut off where the process was killed."""
    with path.open(encoding="utf-8") as file:
        for text in file:
            if not text.endswith("\n"):
                return
            ((kind, value),) = json.loads(text).items()
            yield kind, decoded(value)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m nocturne_coordinator.replay", description="Replays an event log of the coordinator."
    )
    parser.add_argument("file", type=Path, help="written by nocturne-coordinator --event-log FILE")
    try:
        events, instructions = replay(read_lines(parser.parse_args(arguments).file), say=True)
    except ReplayMismatch as difference:
        print(difference, file=sys.stderr)  # noqa: T201
        return 1
    print(f"{events} events, {instructions} instructions: the same as then")  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main())
