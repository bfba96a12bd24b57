"""The reason why a render waits, in a sentence, and the metrics for Prometheus."""

from dataclasses import replace
from typing import Any

import httpx
from nocturne.v1 import job_pb2
from nocturne_api.operations.status_reason import Situation, sentence
from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
from nocturne_coordinator.store.data_folder import DataFolder
from prometheus_client.parser import text_string_to_metric_families

_ENGINE = int(job_pb2.ENGINE_CURRENT)
_WORKER = WorkerRow("w", _ENGINE, 4, 0, 0, 0.0, 0, 0.0, 0.0)


def situation(folder: DataFolder, **changes: Any) -> Situation:
    row = replace(folder.renders.page(1, "")[0][0], **changes.pop("render", {}))
    values: dict[str, Any] = {
        "render": row,
        "meters": {"coordinator_seen": 1000.0, "redis_in_step": 1.0, "worker_threads": 4.0},
        "workers": [_WORKER],
        "quarantined": {},
        "running": 1,
        "incompatible": {},
    }
    return Situation(**(values | changes))


async def test_why_tells_the_first_thing_in_the_way(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    said = (await rest.get(f"/v1/renders/{render_id}/explanation")).json()["sentence"]
    assert said
    good = {"coordinator_seen": 1000.0, "redis_in_step": 1.0, "worker_threads": 4.0}
    running = {"state": RenderState.RUNNING, "photons_per_second": 5.0, "predicted_end": 1600.0}
    for changes, words in (
        ({"render": {"state": RenderState.DEGRADED, "reason": "Tile 3."}}, "It has ended: DEGRADED. Tile 3."),
        ({"render": {"state": RenderState.PAUSED}}, "paused"),
        ({"meters": {}}, "No coordinator"),
        ({"meters": {**good, "folder_trouble": 1.0}}, "can't write"),
        ({"meters": {**good, "redis_in_step": 0.0}}, "can't reach Redis"),
        ({"workers": []}, "No worker is there"),
        ({"quarantined": {"w": "lied"}}, "in quarantine"),
        ({"workers": [replace(_WORKER, engine=1)]}, f"engine 1, and it needs engine {_ENGINE}"),
        (
            {
                "render": {"floating_point_profile": "a" * 16},
                "workers": [replace(_WORKER, floating_point_profile="b" * 16)],
            },
            f"floating-point profile {'a' * 16}. The workers that are there have {'b' * 16}, which",
        ),
        (
            {"render": running, "incompatible": {"w": "It rounds otherwise."}},
            "on 4 worker threads, alone. 1 worker gets no jobs",
        ),
        ({"render": running, "running": 3}, "shared with 2 other renders. It should end"),
        ({"running": 8}, "until one of 8 running renders ends"),
        ({"running": 0}, "about to start"),
        ({"render": running}, "in 10 minutes"),
        ({"render": {**running, "tiles_done": 2}}, "audits"),
        ({"render": {**running, "photons_per_second": 0.0}}, "No result came back"),
    ):
        assert words in sentence(situation(folder, **changes), 1000.0)


async def test_metrics_are_what_prometheus_reads(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    await rest.post("/v1/renders", json=body)
    folder.database.execute("INSERT INTO meter VALUES (1, 'results_refused', 3.0)")
    answer = await rest.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
    samples = {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }
    assert samples["nocturne_renders", "QUEUED"] == 1
    assert samples["nocturne_results_refused_total",] == 3
    assert samples["nocturne_backlog_ranges",] == 2 * 3
