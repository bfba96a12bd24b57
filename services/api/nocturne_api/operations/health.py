"""Health: figures in the text format of Prometheus."""

from collections.abc import Iterator, Mapping

from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.store.data_folder import DataFolder
from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

from nocturne_api.access import CALLER
from nocturne_api.background.space import Space
from nocturne_api.certificate import Certificate
from nocturne_api.operations.folder_access import FolderAccess

_METERS = {
    "coordinator_seen": "Unix time at which the coordinator last wrote to the data folder.",
    "redis_in_step": "1 while the coordinator knows what is on the streams.",
    "folder_trouble": "1 while the coordinator can't commit.",
    "worker_threads": "Threads of workers that take jobs.",
    "jobs_in_flight": "Jobs published and not merged.",
    "jobs_published": "Jobs on the stream.",
    "results_waiting": "Results on the stream that are not committed.",
    "result_seconds": "Longest time that a result waited to be read, lately.",
    "job_seconds": "Median time from publishing a job to its result.",
}
_COUNTS = {
    "results_refused": "Results that could not be right, since the coordinator started.",
    "audits_agreed": "Jobs traced twice with the same result, since the coordinator started.",
    "audits_differing": "Jobs traced twice with different results, since the coordinator started.",
    "audits_given_up": "Jobs that nobody else was there to trace again, since the coordinator started.",
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
        backlog = "Ranges of queued and running renders that are not merged: what to scale workers by."
        yield GaugeMetricFamily("nocturne_backlog_ranges", backlog, value=self._folder.renders.backlog())
        totals = self._folder.renders.totals()
        yield CounterMetricFamily("nocturne_samples", "Samples merged, of all renders.", value=totals.samples)
        yield CounterMetricFamily("nocturne_rays", "Rays traced for them.", value=totals.rays)
        yield CounterMetricFamily(
            "nocturne_cpu_seconds", "Processor time of workers, of all renders.", value=totals.cpu_seconds
        )

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
    """Prometheus' text format, version 0.0.4; `space`: by name, as in Space.figures. `expires`: the
    certificate."""
    registry = CollectorRegistry()
    registry.register(_Collector(folder, {**space, "certificate_expires": expires}))
    return generate_latest(registry)


class Health:
    """How the service is doing."""

    def __init__(self, access: FolderAccess, space: Space) -> None:
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
