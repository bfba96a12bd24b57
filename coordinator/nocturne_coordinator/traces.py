"""Traces of renders by OpenTelemetry: from the request to each range in the database, over all processes.

A render's trace has an id that is made of the render's own, so API and coordinators add to one trace without
telling each other. On where OTEL_EXPORTER_OTLP_ENDPOINT says where spans go; the other variables of the
OpenTelemetry specification hold as well.
"""

import hashlib
import logging
import os
import threading
import time
from collections.abc import Iterable, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.records import RenderCommit
from nocturne_coordinator.errors import UnusableFolder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from opentelemetry.sdk.trace import SpanProcessor
    from opentelemetry.trace import Span

_log = logging.getLogger(__name__)

_ENDPOINTS = ("OTEL_EXPORTER_OTLP_TRACES_ENDPOINT", "OTEL_EXPORTER_OTLP_ENDPOINT")
_OPEN_SPANS = 100_000
"""Ranges that are published and not committed, at most."""


class Traces:
    """Does nothing: nobody asked for traces."""

    def submitted(self, render_id: str, begun: float, about: Mapping[str, str | int]) -> None:
        """A render was made; `begun`: unix time at which the request for it came."""

    def published(self, jobs: Iterable[bytes]) -> None:
        """These jobs are on the stream."""

    def came(self, result: bytes) -> None:
        """A result was read, before it is judged."""

    def committed(self, commits: Iterable[RenderCommit]) -> None:
        """All that these hold is in the database."""

    def close(self) -> None:
        """Sends what is left."""


def start_traces(program: str) -> Traces:
    """Those of a process: `nocturne-` and this name is the service that spans are of. Raises UnusableFolder
    where traces are asked for and the packages are not there."""
    if not any(os.environ.get(name) for name in _ENDPOINTS):
        return Traces()
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
        from opentelemetry.sdk.trace.export import BatchSpanProcessor
    except ImportError:
        raise UnusableFolder(
            f"{_ENDPOINTS[1]} asks for traces, for which packages are missing: install nocturne[traces]"
        ) from None
    return OpenTelemetryTraces(program, BatchSpanProcessor(OTLPSpanExporter()))


class OpenTelemetryTraces(Traces):
    """One span for the request, and one for each range from the stream to the database."""

    def __init__(self, program: str, processor: "SpanProcessor") -> None:
        from opentelemetry.sdk.resources import SERVICE_NAME, Resource
        from opentelemetry.sdk.trace import TracerProvider

        self._ids = _ids()
        resource = Resource.create({SERVICE_NAME: f"nocturne-{program}"})
        self._provider = TracerProvider(resource=resource, id_generator=self._ids)
        self._provider.add_span_processor(processor)
        self._tracer = self._provider.get_tracer("nocturne")
        self._open: dict[tuple[str, int], dict[int, tuple[int, Span]]] = {}
        self._count = 0

    def submitted(self, render_id: str, begun: float, about: Mapping[str, str | int]) -> None:
        from opentelemetry.context import Context

        with self._ids.given(*_trace_and_span(render_id)):
            span = self._tracer.start_span(
                "submit",
                Context(),
                start_time=int(begun * 1e9),
                attributes={"nocturne.render": render_id, **about},
            )
        span.end()

    def published(self, jobs: Iterable[bytes]) -> None:
        for data in jobs:
            job = job_pb2.Job.FromString(data)
            of_tile = self._open.setdefault((job.render_id, job.tile_index), {})
            # A copy of a job is the same range again.
            if job.first_sample in of_tile:
                continue
            self._make_room()
            self._count += 1
            span = self._tracer.start_span(
                "range",
                _inside(job.render_id),
                attributes={
                    "nocturne.render": job.render_id,
                    "nocturne.tile": job.tile_index,
                    "nocturne.first_sample": job.first_sample,
                    "nocturne.end_sample": job.end_sample,
                },
            )
            of_tile[job.first_sample] = job.end_sample, span

    def came(self, result: bytes) -> None:
        try:
            read = job_pb2.JobResult.FromString(result)
        except DecodeError:
            return
        found = self._open.get((read.job.render_id, read.job.tile_index), {}).get(read.job.first_sample)
        if found is not None:
            about: dict[str, str | float] = {
                "nocturne.worker": read.worker_id,
                "nocturne.cpu_seconds": read.partial.cpu_seconds,
            }
            if read.WhichOneof("outcome") == "failure":
                about["nocturne.failure"] = read.failure
            found[1].add_event("result", about)

    def committed(self, commits: Iterable[RenderCommit]) -> None:
        now = time.time_ns()
        for commit in commits:
            for tile in commit.tiles:
                self._end(commit.render_id, tile.tile_index, tile.samples, now)

    def _end(self, render_id: str, tile_index: int, samples: int, now: int) -> None:
        of_tile = self._open.get((render_id, tile_index), {})
        for first, (end, span) in list(of_tile.items()):
            if end <= samples:
                span.end(now)
                del of_tile[first]
                self._count -= 1
        if not of_tile:
            self._open.pop((render_id, tile_index), None)

    def _make_room(self) -> None:
        """Ends the oldest, such as those of renders that ended early, or that others work on now."""
        while self._count >= _OPEN_SPANS:
            oldest = self._open.pop(next(iter(self._open)))
            for _, span in oldest.values():
                span.add_event("not committed here")
                span.end()
            self._count -= len(oldest)

    def close(self) -> None:
        self._provider.shutdown()


def _trace_and_span(render_id: str) -> tuple[int, int]:
    """Of a render's trace, and of the span of its request."""
    digest = hashlib.sha256(f"nocturne {render_id}".encode()).digest()
    return int.from_bytes(digest[:16], "big"), int.from_bytes(digest[16:24], "big")


def _inside(render_id: str) -> Any:
    """The context of what belongs to the request's span, which another process has."""
    from opentelemetry.trace import NonRecordingSpan, SpanContext, TraceFlags, set_span_in_context

    trace, span = _trace_and_span(render_id)
    parent = SpanContext(trace, span, is_remote=True, trace_flags=TraceFlags(TraceFlags.SAMPLED))
    return set_span_in_context(NonRecordingSpan(parent))


def _ids() -> Any:
    """Random ids, but for those that are given."""
    from opentelemetry.sdk.trace.id_generator import RandomIdGenerator

    class Ids(RandomIdGenerator):
        def __init__(self) -> None:
            self._here = threading.local()

        @contextmanager
        def given(self, trace: int, span: int) -> "Iterator[None]":
            self._here.ids = trace, span
            try:
                yield
            finally:
                self._here.ids = None

        def generate_trace_id(self) -> int:
            given: tuple[int, int] | None = getattr(self._here, "ids", None)
            return given[0] if given else super().generate_trace_id()

        def generate_span_id(self) -> int:
            given: tuple[int, int] | None = getattr(self._here, "ids", None)
            return given[1] if given else super().generate_span_id()

    return Ids()
