"""Spans of a render: the request, and each range until it is committed; in one trace for all processes."""

from collections.abc import Iterator
from typing import Any

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import traces
from nocturne_coordinator.dispatch.records import RenderCommit, TileRow, Totals
from nocturne_coordinator.traces import OpenTelemetryTraces, Traces, start_traces
from opentelemetry.sdk.trace.export import SimpleSpanProcessor
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter


class Kept:
    """What one process exports."""

    def __init__(self, program: str) -> None:
        self._exporter = InMemorySpanExporter()
        self.traces = OpenTelemetryTraces(program, SimpleSpanProcessor(self._exporter))

    @property
    def spans(self) -> tuple[Any, ...]:
        return self._exporter.get_finished_spans()


@pytest.fixture
def coordinator() -> Iterator[Kept]:
    kept = Kept("coordinator")
    yield kept
    kept.traces.close()


def job(first: int, end: int, tile: int = 0, render: str = "r-1") -> bytes:
    return job_pb2.Job(
        render_id=render, tile_index=tile, first_sample=first, end_sample=end
    ).SerializeToString()


def result(of: bytes, worker: str = "w") -> bytes:
    return job_pb2.JobResult(
        job=job_pb2.Job.FromString(of), worker_id=worker, partial=job_pb2.Partial(cpu_seconds=2.5)
    ).SerializeToString()


def commit(samples: int, tile: int = 0, render: str = "r-1") -> RenderCommit:
    tiles = [TileRow(tile, samples, b"", 0)]
    return RenderCommit(render, 1, tiles, Totals(), 0.0)


def test_without_an_address_there_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OTEL_EXPORTER_OTLP_ENDPOINT", raising=False)
    monkeypatch.delenv("OTEL_EXPORTER_OTLP_TRACES_ENDPOINT", raising=False)
    assert type(start_traces("api")) is Traces


def test_a_range_ends_when_its_samples_are_committed(coordinator: Kept) -> None:
    coordinator.traces.published([job(0, 4), job(4, 12), job(0, 4, tile=1)])
    coordinator.traces.published([job(0, 4)])
    coordinator.traces.came(result(job(4, 12), "early"))
    coordinator.traces.came(b"\xff no result")
    assert not coordinator.spans
    coordinator.traces.came(result(job(0, 4)))
    coordinator.traces.committed([commit(4), commit(4, tile=1, render="r-2")])
    (span,) = coordinator.spans
    assert dict(span.attributes) == {
        "nocturne.render": "r-1",
        "nocturne.tile": 0,
        "nocturne.first_sample": 0,
        "nocturne.end_sample": 4,
    }
    (event,) = span.events
    assert dict(event.attributes) == {"nocturne.worker": "w", "nocturne.cpu_seconds": 2.5}
    assert span.start_time <= event.timestamp <= span.end_time
    coordinator.traces.committed([commit(12), commit(4, tile=1)])
    assert [
        (each.attributes["nocturne.tile"], each.attributes["nocturne.end_sample"])
        for each in coordinator.spans
    ] == [
        (0, 4),
        (0, 12),
        (1, 4),
    ]


def test_all_processes_add_to_one_trace(coordinator: Kept) -> None:
    """Neither tells the other anything."""
    api, other = Kept("api"), Kept("coordinator")
    try:
        api.traces.submitted("r-1", 1000.5, {"nocturne.owner": "ann"})
        api.traces.submitted("r-2", 1000.5, {})
        for kept in (coordinator, other):
            kept.traces.published([job(0, 4)])
            kept.traces.committed([commit(4)])
        first, second = api.spans
        ranges = [coordinator.spans[0], other.spans[0]]
        assert first.parent is None
        assert first.start_time == 1_000_500_000_000
        assert first.attributes["nocturne.owner"] == "ann"
        for span in ranges:
            assert span.context.trace_id == span.parent.trace_id == first.context.trace_id
            assert span.parent.span_id == first.context.span_id
        assert second.context.trace_id != first.context.trace_id
        ids = {span.context.span_id for span in (first, second, *ranges)}
        assert len(ids) == 4
        assert first.resource.attributes["service.name"] == "nocturne-api"
    finally:
        api.traces.close()
        other.traces.close()


def test_what_is_never_committed_makes_room(coordinator: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(traces, "_OPEN_SPANS", 10)
    for tile in range(25):
        coordinator.traces.published([job(0, 4, tile)])
    assert [span.events[0].name for span in coordinator.spans] == 15 * ["not committed here"]
    coordinator.traces.committed([commit(4, tile=24)])
    assert coordinator.spans[-1].attributes["nocturne.tile"] == 24
