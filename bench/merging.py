"""What a result costs the coordinator without Redis: a real coordinator and a real folder, and in place of
Redis a queue whose jobs are done at once. `python -m bench.merging [--seconds S] [--profile FILE]`."""

import argparse
import cProfile
import tempfile
import time
from collections import deque
from collections.abc import Iterable, Mapping
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_coordinator.clock import Clock
from nocturne_coordinator.coordinator import Coordinator
from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.heartbeat import Heartbeat
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.queue.job_queue import Entry, JobQueue, ResultEntry, Session
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership

from bench.fleet import ResultMaker
from bench.scale import night_of_renders

_BATCH = 100
_WORKERS = 64
_WARM_S = 3.0


class InstantQueue(JobQueue):
    """Each job has its result as soon as it is published; what making results takes is counted apart."""

    def __init__(self, clock: Clock) -> None:
        self.guard = None
        self.made_cpu_s = 0.0
        self._clock = clock
        self._results: deque[tuple[bytes, bytes]] = deque()
        self._maker = ResultMaker()
        self._known = False
        self._entries = 0

    def attend(self, session: Session) -> bool:
        del session
        known, self._known = self._known, True
        return known

    def publish(self, jobs: Iterable[bytes], quick: bool = False) -> list[bytes]:
        del quick
        began = time.process_time()
        entries = []
        for job in jobs:
            self._entries += 1
            entries.append(f"{int(1000 * self._clock.moment().unix)}-{self._entries}".encode())
            self._results.append((entries[-1], job))
        self.made_cpu_s += time.process_time() - began
        return entries

    def results(self, after: bytes, wait_ms: int) -> list[ResultEntry]:
        del after, wait_ms
        began = time.process_time()
        found = [self._results.popleft() for _ in range(min(_BATCH, len(self._results)))]
        made = [
            ResultEntry(entry, self._maker.result(job, f"w{number % _WORKERS}", 0.0))
            for number, (entry, job) in enumerate(found)
        ]
        self.made_cpu_s += time.process_time() - began
        return made

    def workers(self) -> list[tuple[str, bytes, int]]:
        names = [f"w{number}" for number in range(_WORKERS)]
        return [
            (
                name,
                job_pb2.WorkerStatus(
                    worker_id=name, engine=job_pb2.ENGINE_CURRENT, threads=1, started=1.0
                ).SerializeToString(),
                10_000,
            )
            for name in names
        ]

    def jobs(self) -> list[Entry]:
        return []

    def holders(self) -> list[Holder]:
        return []

    def jobs_waiting(self) -> int:
        return 0

    def results_waiting(self) -> int:
        return 0

    def delete_jobs(self, entries: list[bytes]) -> None:
        """They are done."""

    def stop_jobs(self, entries: list[bytes]) -> None:
        """They are done."""

    def delete_results(self, entries: list[bytes]) -> None:
        """They are read."""

    def keep_in_quarantine(self, workers: Mapping[str, str]) -> None:
        """Nobody is."""

    def give_up_session(self, session: Session) -> None:
        """Nobody else wants it."""


def main() -> None:
    """Prints microseconds of processor time a result."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--profile", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as place:
        folder = DataFolder(Path(place) / "data")
        night_of_renders(folder)
        ownership = Ownership(folder.root, folder.database)
        ledger, clock = Ledger(folder.database, ownership), Clock()
        queue = InstantQueue(clock)
        session = Session(ownership.folder, ownership.epoch, "bench")
        settings = Settings(ownership.number, job_seconds=1e9)
        previews = Previews(folder, ledger, Heartbeat())
        coordinator = Coordinator(folder, ledger, previews, queue, session, settings, clock)
        _rounds(coordinator, _WARM_S)
        merged, made, cpu = coordinator.core.results.merged, queue.made_cpu_s, time.process_time()
        profile = cProfile.Profile() if options.profile else None
        if profile:
            profile.enable()
        _rounds(coordinator, options.seconds)
        if profile:
            profile.disable()
            profile.dump_stats(options.profile)
        cpu = time.process_time() - cpu - (queue.made_cpu_s - made)
        merged = coordinator.core.results.merged - merged
        print(f"{merged} results, {1e6 * cpu / merged:.0f} us each")
        ownership.release()
        folder.close()


def _rounds(coordinator: Coordinator, seconds: float) -> None:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        coordinator.round()


if __name__ == "__main__":
    main()
