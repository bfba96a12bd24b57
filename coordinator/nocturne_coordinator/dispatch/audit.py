"""Traces a share of the jobs once more, elsewhere. Pure.

Results are bit-exact, so two that differ prove that one worker is faulty or lies. Which one, a third one
tells: who agrees with another is right. Two results of one worker that differ prove it at once.
"""

import hashlib
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.scheduler import JobKey, Published
from nocturne_coordinator.enrolment import token_of
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


def _owners(machines: Iterable[str]) -> set[str]:
    return {token_of(machine) for machine in machines}


@dataclass(slots=True)
class _Audit:
    witnesses: dict[str, bytes]
    """First digest by worker; the first worker is the author of the merged result."""
    differs: bool = False
    asks: int = 0
    published: Published | None = None


@dataclass(slots=True)
class Finding:
    """What a result that came again showed."""

    agreed: bool = False
    mismatching: dict[str, str] = field(default_factory=dict)
    """Workers that are proven faulty, and by what."""
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
        """To be published."""
        self._alone: set[JobKey] = set()
        """To be published as soon as anybody else works than who did them."""
        self.agreed = 0
        self.mismatches = 0
        self.given_up = 0
        self.unsettled: Counter[str] = Counter()
        """By render, the audits that were given up and are not counted in its totals yet."""

    def accepted(
        self,
        key: JobKey,
        worker: str,
        partial: job_pb2.Partial,
        live: Callable[[], Collection[str]],
        draw: float,
    ) -> None:
        """A result was taken; perhaps it is to be audited, later if no other worker is there by now.

        `draw`: at random in [0, 1), not to be foreseen by a worker that lies only where nobody looks.
        """
        self._results[worker] += 1
        share = self._new_share if self._results[worker] <= NEW_RESULTS else self._share
        if draw >= share:
            return
        if len(self._open) >= MAX_AUDITS:
            self._give_up(key.render_id)
            return
        self._open[key] = _Audit({worker: digest_of(partial)})
        if any(other != worker for other in live()):
            self._waiting.append(key)
        else:
            self._alone.add(key)

    def look(self, live: Callable[[str], Collection[str]]) -> None:
        """Who works may have changed; `live`: by render, who could trace its jobs."""
        for key in list(self._alone):
            if any(worker not in self._open[key].witnesses for worker in live(key.render_id)):
                self._alone.remove(key)
                self._waiting.append(key)

    def again(self, key: JobKey, worker: str, partial: job_pb2.Partial, live: Collection[str]) -> Finding:
        """A valid result of a job that was done before. Nobody confirms its own result; machines of one
        token confirm each other where no other token's are `live`."""
        audit = self._open.get(key)
        if audit is None:
            return Finding()
        finding = Finding(withdrawn=audit.published.entries if audit.published else [])
        audit.published = None
        digest, witnesses = digest_of(partial), audit.witnesses
        author = next(iter(witnesses))
        is_confirmed = False
        if witnesses.setdefault(worker, digest) != digest:
            finding.mismatching[worker] = "It sent two different results"
        else:
            alike = [other for other, seen in witnesses.items() if seen == digest]
            differing = [other for other in witnesses if other not in alike]
            is_believed = len(_owners(alike)) > 1 or (len(alike) > 1 and len(_owners(witnesses)) == 1)
            is_confirmed = is_believed and (len(_owners(alike)) > 1 or len(_owners([*alike, *live])) == 1)
            if is_believed:
                proof = "Its result differs from that of two other workers"
                finding.mismatching = dict.fromkeys(differing, proof)
        self._differs(audit, finding)
        for worker in finding.mismatching:
            del witnesses[worker]
        if is_confirmed:
            finding.agreed = True
            self.agreed += 1
        if is_confirmed or author in finding.mismatching:
            # Of an author whose results mismatch all work is thrown away; who does it again may be audited.
            self._close(key)
        else:
            self._ask_again(key, audit)
        return finding

    def _differs(self, audit: _Audit, finding: Finding) -> None:
        if not audit.differs and (finding.mismatching or len(set(audit.witnesses.values())) > 1):
            audit.differs = True
            self.mismatches += 1

    def _ask_again(self, key: JobKey, audit: _Audit) -> None:
        if key in self._alone:
            # The same worker has done the job again, and no other is there yet.
            return
        if audit.asks < _ASKS or len(set(audit.witnesses.values())) > 1:
            if key not in self._waiting:
                self._waiting.append(key)
        else:
            self._give_up(key.render_id)
            self._close(key)

    def _give_up(self, render_id: str) -> None:
        self.given_up += 1
        self.unsettled[render_id] += 1

    def take(self, count: int) -> list[JobKey]:
        """Up to `count` jobs to publish; `published` must follow, or `returned`."""
        taken, self._waiting = self._waiting[: max(0, count)], self._waiting[max(0, count) :]
        return taken

    def published(self, key: JobKey, entry: bytes, now: float) -> None:
        """The audit is on the stream."""
        if key in self._open:
            self._open[key].asks += 1
            self._open[key].published = Published([entry], now)

    def copied(self, key: JobKey, entry: bytes) -> None:
        """An audit that is out is on the stream once more."""
        if published := self._open[key].published:
            published.entries.append(entry)

    def stopped_quick(self, key: JobKey) -> list[bytes]:
        """A quick copy came to no end; gives its entries, the audit itself stays out."""
        audit = self._open.get(key)
        return audit.published.without_quick() if audit and audit.published else []

    def out(self, renders: Collection[str]) -> list[tuple[JobKey, Published]]:
        """The audits of jobs of these renders that are out."""
        return [
            (key, audit.published)
            for key, audit in self._open.items()
            if audit.published and key.render_id in renders
        ]

    @property
    def outstanding(self) -> int:
        """Audits that are out."""
        return sum(audit.published is not None for audit in self._open.values())

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

    def is_out(self, key: JobKey) -> bool:
        """Whether an audit of that job is on the stream."""
        return key in self._open and self._open[key].published is not None

    def is_open(self, key: JobKey) -> bool:
        return key in self._open

    def pending(self, render_id: str) -> bool:
        """Whether an audit of a render is not settled."""
        return any(key.render_id == render_id for key in self._open)

    def open_by_render(self) -> Counter[str]:
        """How many audits of each render are not settled."""
        return Counter(key.render_id for key in self._open)

    def only_others_could(self, render_id: str, live: Collection[str]) -> bool:
        """Whether all open audits of a render wait for somebody to come: the worker that did the work is
        there, and no other ever was."""
        return all(
            key in self._alone and not audit.witnesses.keys().isdisjoint(live)
            for key, audit in self._open.items()
            if key.render_id == render_id
        )

    def disputed(self, render_id: str) -> list[tuple[JobKey, list[str]]]:
        """Jobs of which two workers say different things and no third has spoken."""
        return [
            (key, sorted(audit.witnesses))
            for key, audit in self._open.items()
            if key.render_id == render_id and len(set(audit.witnesses.values())) > 1
        ]

    def give_up(self, render_id: str) -> list[bytes]:
        """The render ends, or is let go: unsettled audits are counted, except disputed ones. Gives
        entries to delete."""
        keys = [
            key
            for key, audit in self._open.items()
            if key.render_id == render_id and len(set(audit.witnesses.values())) == 1
        ]
        for _ in keys:
            self._give_up(render_id)
        return self._drop(keys)

    def forget(self, render_id: str, kept: Sequence[int] | None = None) -> list[bytes]:
        """The render is not worked on any more, or only by the `kept` first ranges of each queue; gives
        entries to delete."""
        keys = [
            key
            for key in self._open
            if key.render_id == render_id and (kept is None or key.range_index >= kept[key.tile_index])
        ]
        if kept is None:
            self.unsettled.pop(render_id, None)
        return self._drop(keys)

    def _drop(self, keys: Iterable[JobKey]) -> list[bytes]:
        entries = []
        for key in keys:
            audit = self._open[key]
            entries.extend(audit.published.entries if audit.published else [])
            self._close(key)
        return entries

    def _close(self, key: JobKey) -> None:
        del self._open[key]
        self._alone.discard(key)
        if key in self._waiting:
            self._waiting.remove(key)
