"""Health: figures in the text format of Prometheus."""

from collections.abc import Iterator, Mapping

from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.store.data_folder import DataFolder
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

from nocturne_api.access import CALLER
from nocturne_api.background.space import DiskQuota
from nocturne_api.certificate import Certificate
from nocturne_api.operations.folder_access import FolderAccess

_METERS = {
    "coordinator_seen": "Unix time at which the coordinator last wrote to the data folder.",
    "redis_in_step": "1 while the coordinator knows what is on the streams.",
    "folder_trouble": "1 while the coordinator can't commit.",
    "worker_threads": "Threads of workers that take jobs.",
    "machines": "Most machines that work and round alike: with one, nothing is audited.",
    "jobs_in_flight": "Jobs published and not merged.",
    "jobs_published": "Jobs on the stream.",
    "results_waiting": "Results on the stream that are not committed.",
    "result_seconds": "Longest time that a result waited to be read, lately.",
    "job_seconds": "Median time from publishing a job to its result.",
}
_COUNTS = {
    "quick_copies": "Jobs of small renders put on the stream of quick copies, since the coordinator started.",
    "results_refused": "Results that could not be right, since the coordinator started.",
    "audits_agreed": "Jobs traced twice with the same result, since the coordinator started.",
    "audits_differing": "Jobs traced twice with different results, since the coordinator started.",
    "audits_given_up": "Jobs to audit that no other machine traced, since the coordinator started.",
}

_WORK = {
    "samples": "Samples merged, of all renders, deleted ones too.",
    "rays": "Rays traced for them.",
    "cpu_seconds": "Processor time of workers, of all renders, deleted ones too.",
}
_SPACE = {
    "data_bytes": "Size of the data folder when it was last looked at.",
    "data_bytes_bound": "Size at which it takes no more uploads and renders; 0: none.",
    "disk_free_bytes": "What is free on its disk.",
    "certificate_expires": "Unix time at which the certificate of REST and gRPC ends; 0: there is no TLS.",
}


class _Collector:
    def __init__(self, folder: DataFolder, space: Mapping[str, float]) -> None:
        self._folder = folder
        self._space = space

    def collect(self) -> Iterator[Metric]:
        meters = self._folder.meters.read()
        for name, about in _METERS.items():
            yield GaugeMetricFamily(f"nocturne_{name}", about, value=meters.get(name, 0.0))
        for name, about in _COUNTS.items():
            yield CounterMetricFamily(f"nocturne_{name}", about, value=meters.get(name, 0.0))
        for name, about in _SPACE.items():
            yield GaugeMetricFamily(f"nocturne_{name}", about, value=self._space[name])
        yield from self._renders()
        yield from self._workers()

    def _renders(self) -> Iterator[Metric]:
        states = GaugeMetricFamily("nocturne_renders", "Renders by state.", labels=["state"])
        counted = self._folder.renders.count_by_state()
        for state in RenderState:
            states.add_metric([state.value], counted.get(state.value, 0))
        yield states
        backlog = "Ranges of queued and running renders that are not merged."
        yield GaugeMetricFamily("nocturne_backlog_ranges", backlog, value=self._folder.renders.backlog())
        open_work = "Processor seconds that queued and running renders should need: what to scale workers by."
        value = self._folder.renders.open_cpu_seconds()
        yield GaugeMetricFamily("nocturne_open_cpu_seconds", open_work, value=value)
        done = self._folder.renders.counted()
        for name, about in _WORK.items():
            yield CounterMetricFamily(f"nocturne_{name}", about, value=done.get(name, 0.0))
        ended = CounterMetricFamily("nocturne_renders_ended", "Renders that ended.", labels=["state"])
        for state in RenderState:
            if state.ended:
                ended.add_metric([state.value], done.get(f"ended_{state.value}", 0.0))
        yield ended

    def _workers(self) -> Iterator[Metric]:
        workers, quarantined = self._folder.workers.alive(), self._folder.workers.in_quarantine()
        yield GaugeMetricFamily("nocturne_workers", "Workers heard of lately.", value=len(workers))
        yield GaugeMetricFamily(
            "nocturne_workers_in_quarantine", "Workers whose results are not taken.", value=len(quarantined)
        )
        rate = sum(worker.rays_per_second for worker in workers)
        about = "Rays that workers trace each second, as they report it."
        yield GaugeMetricFamily("nocturne_rays_per_second", about, value=rate)


def metrics_text(folder: DataFolder, space: Mapping[str, float], expires: float = 0.0) -> bytes:
    """Prometheus' text format, version 0.0.4; `space`: by name, as in DiskQuota.figures. `expires`: the
    certificate."""
    registry = CollectorRegistry()
    registry.register(_Collector(folder, {**space, "certificate_expires": expires}))
    return generate_latest(registry)


class Health:
    """How the service is doing."""

    def __init__(self, access: FolderAccess, space: DiskQuota) -> None:
        self._access = access
        self._space = space
        self.certificate: Certificate | None = None
        """With TLS, its certificate."""

    async def metrics(self) -> bytes:
        """Counts and states in the text format of Prometheus."""
        CALLER.get().need("read")
        return await self._access.in_database(
            metrics_text,
            self._access.folder,
            self._space.figures(),
            self.certificate.expires if self.certificate else 0.0,
        )
