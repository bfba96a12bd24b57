"""Traces a share of the jobs once more, elsewhere. Pure.

Results are bit-exact, so two that differ prove that one worker is faulty or lies. Which one, a third one
tells: who agrees with another is right.
"""

import hashlib
from collections import Counter
from collections.abc import Callable, Collection
from dataclasses import dataclass, field

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.scheduler import JobKey, Published
from nocturne_coordinator.limits import MAX_AUDITS

SHARE = 0.02
NEW_SHARE = 0.20
NEW_RESULTS = 50
"""A worker is new until it has sent so many."""

MAX_WAIT = 120.0
"""Seconds that an audit may be out before it is asked for again."""

_ASKS = 6
"""Times that an audit is published before it is given up: the worker to be audited may take it every time."""


def digest_of(partial: job_pb2.Partial) -> bytes:
    """The part of a result that must be equal wherever a job is done: all but the processor time."""
    digest = hashlib.sha256(partial.sums)
    counts = (partial.photons, partial.rays, partial.invalid_samples, partial.truncated_paths)
    digest.update(" ".join(map(str, counts)).encode())
    return digest.digest()


@dataclass(slots=True)
class _Audit:
    witnesses: dict[str, bytes]
    """Digest by worker."""
    asks: int = 0
    published: Published | None = None


@dataclass(slots=True)
class Finding:
    """What a result that came again showed."""

    agreed: bool = False
    liars: list[str] = field(default_factory=list)
    withdrawn: list[bytes] = field(default_factory=list)
    """Job entries that are not needed any more."""


class Auditor:
    """The jobs that wait for a second opinion."""

    def __init__(self, share: float = SHARE, new_share: float = NEW_SHARE) -> None:
        self._share = share
        self._new_share = new_share
        self._results: Counter[str] = Counter()
        self._open: dict[JobKey, _Audit] = {}
        self._waiting: list[JobKey] = []
        self.agreed = 0
        self.mismatches = 0
        self.given_up = 0

    def accepted(
        self,
        key: JobKey,
        worker: str,
        partial: job_pb2.Partial,
        live: Callable[[], Collection[str]],
        draw: float,
    ) -> None:
        """A result was taken; perhaps it is to be audited. Nobody is audited while nobody else works.

        `draw`: at random in [0, 1), not to be foreseen by a worker that lies only where nobody looks.
        """
        self._results[worker] += 1
        share = self._new_share if self._results[worker] <= NEW_RESULTS else self._share
        if draw >= share or len(self._open) >= MAX_AUDITS:
            return
        others = live()
        if len(others) - (worker in others) < 1:
            return
        self._open[key] = _Audit({worker: digest_of(partial)})
        self._waiting.append(key)

    def again(self, key: JobKey, worker: str, partial: job_pb2.Partial) -> Finding:
        """A valid result of a job that was done before."""
        audit = self._open.get(key)
        if audit is None:
            return Finding()
        finding = Finding(withdrawn=audit.published.entries if audit.published else [])
        audit.published = None
        digest = digest_of(partial)
        others = {other: seen for other, seen in audit.witnesses.items() if other != worker}
        audit.witnesses[worker] = digest
        if digest in others.values():
            finding.liars = [other for other, seen in audit.witnesses.items() if seen != digest]
            finding.agreed = True
            self.agreed += 1
            self._close(key)
        else:
            if others:
                self.mismatches += len(audit.witnesses) == 2
            self._ask_again(key, audit)
        return finding

    def _ask_again(self, key: JobKey, audit: _Audit) -> None:
        if audit.asks < _ASKS or len(audit.witnesses) > 1:
            if key not in self._waiting:
                self._waiting.append(key)
        else:
            self.given_up += 1
            self._close(key)

    def take(self, count: int) -> list[JobKey]:
        """Up to `count` jobs to publish; `published` must follow, or `returned`."""
        taken, self._waiting = self._waiting[: max(0, count)], self._waiting[max(0, count) :]
        return taken

    def published(self, key: JobKey, entry: bytes, now: float) -> None:
        """The audit is on the stream."""
        if key in self._open:
            self._open[key].asks += 1
            self._open[key].published = Published([entry], now)

    def returned(self, key: JobKey) -> list[bytes]:
        """The audit is to be asked for again; gives its entries that may still be on the stream."""
        audit = self._open.get(key)
        if audit is None:
            return []
        entries = audit.published.entries if audit.published else []
        audit.published = None
        self._ask_again(key, audit)
        return entries

    def lost(self) -> None:
        """The stream was emptied."""
        for key in [key for key, audit in self._open.items() if audit.published]:
            self.returned(key)

    def overdue(self, now: float) -> list[JobKey]:
        """Audits that are out for too long."""
        return [
            key
            for key, audit in self._open.items()
            if audit.published and audit.published.at < now - MAX_WAIT
        ]

    def entries(self) -> dict[bytes, JobKey]:
        """The audits that are out, by their entries."""
        return {
            entry: key
            for key, audit in self._open.items()
            if audit.published
            for entry in audit.published.entries
        }

    def is_open(self, key: JobKey) -> bool:
        return key in self._open

    def pending(self, render_id: str) -> int:
        """Audits of a render that are not settled."""
        return sum(key.render_id == render_id for key in self._open)

    def disputed(self, render_id: str) -> list[tuple[JobKey, list[str]]]:
        """Jobs of which two workers say different things and no third has spoken."""
        return [
            (key, sorted(audit.witnesses))
            for key, audit in self._open.items()
            if key.render_id == render_id and len(audit.witnesses) > 1
        ]

    def forget(self, render_id: str) -> list[bytes]:
        """The render is not worked on any more; gives entries to delete."""
        entries = []
        for key in [key for key in self._open if key.render_id == render_id]:
            audit = self._open[key]
            entries.extend(audit.published.entries if audit.published else [])
            self._close(key)
        return entries

    def _close(self, key: JobKey) -> None:
        del self._open[key]
        if key in self._waiting:
            self._waiting.remove(key)
