"""The workers as they were last seen, and which of them take jobs. Pure."""

from collections import Counter
from collections.abc import Collection, Mapping

from nocturne_coordinator.dispatch.liveness import Liveness
from nocturne_coordinator.dispatch.profiles import incompatible, votes_by_profile
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.enrolment import machine_of, reason_of
from nocturne_coordinator.limits import MAX_THREADS


class Fleet:
    """Who is there, who is in quarantine, drained or incompatible, and what that leaves."""

    def __init__(self) -> None:
        self.liveness = Liveness()
        self.workers: tuple[WorkerRow, ...] = ()
        self.quarantined: Mapping[str, str] = {}
        """Machines, and tokens with all machines, that are to take no jobs, and why."""
        self.drained: Mapping[str, str] = {}
        """Workers that are to take no jobs, though the jobs they finish count, and why."""
        self.incompatible: Mapping[str, str] = {}
        """Workers that are to take no jobs though they are not in quarantine, and why."""
        self.threads = 0
        """Of all workers that take jobs."""
        self.takers = 0
        """Workers that take jobs, each with two further threads for quick copies."""
        self.votes_by_profile: Mapping[str, int] = {}
        """Of all that could work, whatever the renders need; owners, where there are several."""
        self.jobs_of_others = 0
        """On the stream, of other coordinators."""
        self.share = 1.0
        """Part of the workers that this coordinator's renders should get."""
        self._profiles: Collection[str] = ()
        self._live: dict[str, set[str]] = {}
        self._live_of: tuple[object, ...] = (None,) * 4

    def live(self, floating_point_profile: str = "") -> set[str]:
        """Machines whose workers take jobs; of one floating-point profile, unless it is empty."""
        # Asked for often, and long where there are thousands.
        now = (self.workers, self.quarantined, self.incompatible, self.drained)
        if any(a is not b for a, b in zip(now, self._live_of, strict=True)):
            self._live, self._live_of = {"": set()}, now
            for worker in self.workers:
                if self._takes_jobs(worker):
                    machine = machine_of(worker.id)
                    self._live[""].add(machine)
                    self._live.setdefault(worker.floating_point_profile, set()).add(machine)
        return self._live.get(floating_point_profile, set())

    @property
    def alike(self) -> int:
        """Most machines whose workers take jobs and round alike: with fewer than two nothing is audited."""
        self.live()
        return max((len(of) for profile, of in self._live.items() if profile), default=0)

    def seen(self, workers: tuple[WorkerRow, ...]) -> dict[str, str]:
        """Who is there now; gives those that are newly incompatible, and why."""
        self.workers = workers
        self.votes_by_profile = votes_by_profile(workers, self.quarantined)
        found = self._find_incompatible()
        threads: Counter[str] = Counter()
        takers = [worker for worker in workers if self._takes_jobs(worker)]
        self.takers = len(takers)
        for worker in takers:
            threads[machine_of(worker.id)] += worker.threads
        # A machine may report any number for its workers.
        self.threads = sum(min(each, MAX_THREADS) for each in threads.values())
        return found

    def set_profiles(self, profiles: Collection[str]) -> dict[str, str]:
        """Floating-point profiles of all open renders of the folder, empty for one that has none yet; gives
        those that are newly incompatible."""
        if profiles == self._profiles:
            return {}
        self._profiles = profiles
        return self._find_incompatible()

    def without_jobs(self) -> dict[str, str]:
        """All workers and machines that are to take no jobs, and why."""
        of_tokens = {}
        for worker in self.workers:
            machine = machine_of(worker.id)
            if machine not in self.quarantined and (reason := reason_of(machine, self.quarantined)):
                of_tokens[machine] = reason
        return {**self.incompatible, **self.drained, **self.quarantined, **of_tokens}

    def _takes_jobs(self, worker: WorkerRow) -> bool:
        refused = worker.id in self.incompatible or worker.id in self.drained
        return not refused and not reason_of(machine_of(worker.id), self.quarantined)

    def _find_incompatible(self) -> dict[str, str]:
        before, found = self.incompatible, incompatible(self.workers, self.quarantined, self._profiles)
        if found != before:
            # The same object tells `live` that nothing changed.
            self.incompatible = found
        return {worker: found[worker] for worker in found.keys() - before.keys()}
