"""The reason why a render waits, in a sentence, and the metrics for Prometheus."""

import math
from dataclasses import replace
from typing import Any

import httpx
import pytest
from nocturne.v1 import job_pb2
from nocturne_api.operations.status_reason import Situation, sentence, situation_of
from nocturne_coordinator.dispatch.job_cost import USUAL_COST
from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
from nocturne_coordinator.dispatch.stopping import EVERYTHING
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule
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
        ({"is_large": True}, "only one such render runs at a time"),
        ({"running": 0}, "about to start"),
        ({"render": running}, "in 10 minutes"),
        ({"render": {**running, "tiles_done": 2}}, "audits"),
        ({"render": {**running, "photons_per_second": 0.0}}, "No result came back"),
    ):
        assert words in sentence(situation(folder, **changes), 1000.0)


async def test_films_are_large_by_the_rule_that_takes_them_up(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    assert not situation_of(folder, render_id).is_large
    monkeypatch.setattr("nocturne_coordinator.limits.MAX_RUNNING_SUMS", 1)
    assert situation_of(folder, render_id).is_large


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


def _metrics(text: str) -> dict[tuple[str, ...], float]:
    return {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


async def test_counters_do_not_fall(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    """Whatever is deleted, or thrown away to be traced again."""
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    folder.database.execute("UPDATE render SET photons_per_sample = 1")
    work = "UPDATE render SET photons = ?, rays = ?, cpu_seconds = ? WHERE id = ?"
    folder.database.execute(work, (300, 900, 12.5, render_id))
    folder.database.execute(work, (0, 0, 12.5, render_id))
    folder.database.execute(work, (100, 200, 13.0, render_id))
    await rest.post(f"/v1/renders/{render_id}:cancel")
    folder.database.execute("UPDATE render SET image_final = 1")
    wanted = {
        ("nocturne_samples_total",): 400.0,
        ("nocturne_rays_total",): 1100.0,
        ("nocturne_cpu_seconds_total",): 13.0,
        ("nocturne_renders_ended_total", "CANCELLED"): 1.0,
    }
    before = _metrics((await rest.get("/metrics")).text)
    assert {name: before[name] for name in wanted} == wanted
    assert (await rest.delete(f"/v1/renders/{render_id}")).status_code == 204
    after = _metrics((await rest.get("/metrics")).text)
    assert {name: after[name] for name in wanted} == wanted


@pytest.mark.parametrize(
    ("width", "height", "samples", "cost", "workers"),
    [(1920, 1080, 64, 5e-6, 1), (8192, 8192, 1000, 5e-6, 70)],
)
async def test_workers_are_asked_for_by_what_the_work_costs(
    folder: DataFolder, width: int, height: int, samples: int, cost: float, workers: int
) -> None:
    """Of eight threads, for ten minutes: width x height x samples x what a sample costs, over 8 x 600 s."""
    schedule = make_schedule(width, height, samples)
    new = NewRender("r", "", "5c" * 32, "{}", width, height, samples, schedule, EVERYTHING)
    render_id = folder.renders.create(new).id
    assert folder.renders.open_cpu_seconds() == pytest.approx(width * height * samples * USUAL_COST)
    # Another render has shown what a sample costs here.
    folder.database.execute("UPDATE counted SET value = 1e6 WHERE name = 'samples'")
    folder.database.execute("UPDATE counted SET value = 1e6 * ? WHERE name = 'cpu_seconds'", (cost,))
    open_seconds = folder.renders.open_cpu_seconds()
    assert open_seconds == pytest.approx(width * height * samples * cost)
    assert math.ceil(open_seconds / (8 * 600.0)) == workers
    # It knows itself, once it runs.
    folder.database.execute(
        "UPDATE render SET state = 'RUNNING', predicted_cpu_seconds = 50, cpu_seconds = 20"
    )
    assert folder.renders.open_cpu_seconds() == pytest.approx(30.0)
    # Not scaled to zero before its end.
    folder.database.execute("UPDATE render SET cpu_seconds = 60")
    assert folder.renders.open_cpu_seconds() == 1.0
    folder.requests.cancel(render_id)
    assert folder.renders.open_cpu_seconds() == 0.0
