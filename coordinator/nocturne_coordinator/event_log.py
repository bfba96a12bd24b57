"""The event log: events and instructions of the core, one JSON object a line, for
`nocturne_coordinator.replay`.

    {"head": ...}      settings; the first line
    {"event": ...}     the next event given to the core
    {"did": ...}       an instruction that followed: its kind, and a digest of all of it
    {"answer": ...}    its answer, unless that is nothing; {"trouble": ...}: it failed
    {"full": true}     the bound was reached; nothing follows

Values of classes are distinguished by a key that begins with "~". Results are kept as they came, for sums
decide when tiles stop: about 44 kB each. Nothing secret is in it: neither passwords nor tokens ever reach
the core."""

import base64
import dataclasses
import hashlib
import json
import logging
from collections.abc import Mapping
from contextlib import suppress
from enum import Enum
from pathlib import Path
from typing import IO, Any

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch import (
    error_estimate,
    events,
    instructions,
    liveness,
    records,
    region,
    state,
    stopping,
)
from nocturne_coordinator.dispatch.instructions import Instruction, ReadTiles, Steps
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.errors import LeaseLost, QueueError, StoreUnavailable

_log = logging.getLogger(__name__)

MAX_BYTES = 2**30
"""Of a log: some 24,000 results, a night of eight threads with jobs of ten seconds."""

_CLASSES = {
    each.__name__: each
    for module in (error_estimate, events, instructions, liveness, records, region, state, stopping)
    for each in vars(module).values()
    if isinstance(each, type) and dataclasses.is_dataclass(each)
}
TROUBLES = {each.__name__: each for each in (StoreUnavailable, LeaseLost, QueueError)}


class EventLog:
    """Writes a log. The one before it is kept in the same folder, under the same name with ".1"."""

    def __init__(
        self, path: Path, settings: state.Settings, quarantined: Mapping[str, str], max_bytes: int = MAX_BYTES
    ) -> None:
        if path.exists():
            path.replace(path.with_name(path.name + ".1"))
        # Readable by its owner only: it says who renders what.
        path.touch(mode=0o600)
        self._file: IO[str] | None = path.open("w", encoding="utf-8")
        self._left = max_bytes
        self._line("head", {"settings": settings, "quarantined": dict(quarantined)})

    def close(self) -> None:
        if self._file is not None:
            # Buffered lines may not fit on a full disk.
            with suppress(OSError):
                self._file.close()
            self._file = None

    def recorded(self, event: events.Event, steps: Steps[None]) -> Steps[None]:
        """The same steps, written down as they go."""
        self._line("event", event)
        try:
            instruction = next(steps)
            while True:
                self._line("did", summary_of(instruction))
                try:
                    answer = yield instruction
                    if isinstance(instruction, ReadTiles) and self._file is not None:
                        answer = list(answer)
                except tuple(TROUBLES.values()) as trouble:
                    self._line(
                        "trouble", [type(trouble).__name__, getattr(trouble, "render_id", str(trouble))]
                    )
                    instruction = steps.throw(trouble)
                else:
                    if answer is not None:
                        self._line("answer", answer)
                    instruction = steps.send(answer)
        except StopIteration:
            return

    def _line(self, kind: str, value: object) -> None:
        if self._file is None:
            return
        line = json.dumps({kind: encoded(value)}, separators=(",", ":")) + "\n"
        self._left -= len(line)
        try:
            self._file.write(line if self._left > 0 else '{"full":true}\n')
            if kind == "event":
                self._file.flush()
        except OSError as trouble:
            _log.error("the event log ends here: %s", trouble)
            self._left = 0
        if self._left <= 0:
            _log.warning("the event log is full, or can't be written; nothing more is added")
            self.close()


def summary_of(instruction: Instruction) -> list[str]:
    """An instruction's kind, and what tells it from all others."""
    text = json.dumps(encoded(instruction), separators=(",", ":"), sort_keys=True)
    return [type(instruction).__name__, hashlib.sha256(text.encode()).hexdigest()[:16]]


def encoded(value: Any) -> Any:
    """As JSON has it."""
    match value:
        case bytes():
            return {"~bytes": base64.b64encode(value).decode()}
        case JobKey():
            return {"~key": list(value)}
        case events.Moment():
            return {"~at": list(value)}
        case Enum():
            return {"~state": value.value}
        case job_pb2.RangeSchedule():
            return {"~schedule": base64.b64encode(value.SerializeToString(deterministic=True)).decode()}
        case tuple():
            return {"~tuple": [encoded(each) for each in value]}
        case list() | records.TileRows():
            return [encoded(each) for each in value]
        case set() | frozenset():
            return {"~set": sorted(value)}
        case Mapping():
            return {"~map": [[encoded(key), encoded(each)] for key, each in value.items()]}
        case _ if dataclasses.is_dataclass(value):
            fields = {each.name: encoded(getattr(value, each.name)) for each in dataclasses.fields(value)}
            return {f"~{type(value).__name__}": fields}
        case _:
            return value


def decoded(value: Any) -> Any:
    """What `encoded` was given; ValueError for anything else."""
    if isinstance(value, list):
        return [decoded(each) for each in value]
    if not isinstance(value, dict):
        return value
    ((name, content),) = value.items()
    match name:
        case "~bytes":
            return base64.b64decode(content)
        case "~key":
            return JobKey(*content)
        case "~at":
            return events.Moment(*content)
        case "~state":
            return records.RenderState(content)
        case "~schedule":
            return job_pb2.RangeSchedule.FromString(base64.b64decode(content))
        case "~tuple":
            return tuple(decoded(each) for each in content)
        case "~set":
            return set(content)
        case "~map":
            return {decoded(key): decoded(each) for key, each in content}
        case _ if name[1:] in _CLASSES:
            return _CLASSES[name[1:]](**{key: decoded(each) for key, each in content.items()})
        case _:
            raise ValueError(f"{name} is nothing that an event log has")
