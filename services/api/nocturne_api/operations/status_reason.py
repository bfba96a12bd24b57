"""What a render waits for, in one sentence: the answer to "why does nothing happen?"."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.film_memory import max_numbers, numbers_of
from nocturne_coordinator.dispatch.profiles import machines_by_profile
from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
from nocturne_coordinator.enrolment import machine_of, reason_of
from nocturne_coordinator.limits import MAX_RUNNING, WORKER_SECONDS
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.groups import Groups
from nocturne_coordinator.store.open_renders import find_render
from nocturne_coordinator.store.rows import RenderRow


@dataclass(frozen=True)
class Situation:
    """All that decides whether a render gets on."""

    render: RenderRow
    meters: dict[str, float]
    workers: list[WorkerRow]
    quarantined: dict[str, str]
    running: int
    """Renders that run."""
    incompatible: dict[str, str]
    """Workers that get no jobs though they are not in quarantine, and why."""
    is_large: bool = False
    """Its film is larger than those that share the memory."""
    waits_for_group: bool = False


def situation_of(folder: DataFolder, render_id: str) -> Situation:
    """What the data folder knows; raises NotFound."""
    found = find_render(folder.database, render_id)
    return Situation(
        render=folder.renders.get(render_id),
        meters=folder.meters.read(),
        workers=folder.workers.alive(),
        quarantined=folder.workers.in_quarantine(),
        running=folder.renders.count_running(),
        incompatible=folder.workers.incompatible(),
        is_large=found is not None and numbers_of(found.schedule) > max_numbers(0),
        waits_for_group=Groups(folder.database).waits(render_id),
    )


def sentence(situation: Situation, now: float) -> str:
    """One sentence, for people."""
    render = situation.render
    if render.state.ended:
        return f"It has ended: {render.state}. {render.reason}".strip()
    if render.state is RenderState.PAUSED:
        return "It is paused; resume it to go on."
    if situation.waits_for_group:
        return f"It waits until the group {render.after_group} has ended."
    return _trouble(situation, now) or _queued(situation) or _running(situation, now)


def coordinator_trouble(meters: Mapping[str, float], now: float, max_silence: float) -> str:
    """Why no result is merged, a sentence; empty: results are merged. `max_silence`: seconds for which a
    coordinator may write nothing."""
    if "coordinator_seen" not in meters:
        return "No coordinator works on the data folder: start one."
    silent = now - meters["coordinator_seen"]
    if silent > max_silence:
        return (
            f"No coordinator works on the data folder: the last has written nothing for {silent:.0f} s. "
            "Look at its log, and start one."
        )
    if meters.get("folder_trouble"):
        return (
            "The coordinator can't write to the data folder, whose disk may be full; its log has the reason."
        )
    if not meters.get("redis_in_step"):
        return "The coordinator can't reach Redis; its log has the reason."
    return ""


def _trouble(situation: Situation, now: float) -> str:
    """What stops every render."""
    if trouble := coordinator_trouble(situation.meters, now, WORKER_SECONDS):
        return trouble
    engines = {worker.engine for worker in situation.workers}
    quarantined = situation.quarantined
    able = [worker for worker in situation.workers if not reason_of(machine_of(worker.id), quarantined)]
    if not engines:
        return "No worker is there."
    if not able:
        return f"All {len(situation.workers)} workers are in quarantine; `nocturne workers` says why."
    if job_pb2.ENGINE_CURRENT not in engines:
        has = ", ".join(str(engine) for engine in sorted(engines))
        needs = int(job_pb2.ENGINE_CURRENT)
        return f"The workers that are there have engine {has}, and it needs engine {needs}: use one version."
    return _other_profile(situation.render.floating_point_profile, situation)


def _other_profile(needed: str, situation: Situation) -> str:
    """Nobody there rounds as what the render has so far was rounded."""
    found = machines_by_profile(situation.workers, situation.quarantined)
    if not needed or found[needed]:
        return ""
    return (
        f"Its samples were traced by workers of floating-point profile {needed}. The workers that are there "
        f"have {' and '.join(sorted(found))}, which gives other bits, so it waits. "
        "To use these workers, submit it again."
    )


def _queued(situation: Situation) -> str:
    if situation.render.state is not RenderState.QUEUED:
        return ""
    if situation.running >= MAX_RUNNING:
        return (
            f"It waits until one of {situation.running} running renders ends; then the owner with fewest at "
            "work goes first, with the highest of its priorities."
        )
    if situation.running and situation.is_large:
        return "Its film is so large that only one such render runs at a time: it waits for that to end."
    if situation.running:
        return "It waits for memory that running renders use, or is about to start."
    return "It is about to start."


def _running(situation: Situation, now: float) -> str:
    render = situation.render
    threads = int(situation.meters.get("worker_threads", 0))
    if render.tiles and render.tiles_done == render.tiles:
        if render.layers and not render.layers_sha256:
            return "All samples are there; it waits for its layers, which are being made."
        return "All samples are there; it waits for audits, or for its images to be written."
    if render.photons_per_second <= 0.0:
        out = int(situation.meters.get("jobs_published", 0))
        busy = f"{_counted(threads, 'worker thread')} {'is' if threads == 1 else 'are'} busy"
        return (
            f"No result came back in the last minutes: {busy} with the {_counted(out, 'job')} published "
            "before, its own among them or behind them."
        )
    end = "" if not render.predicted_end else f" It should end {_when(render.predicted_end, now)}."
    kept = len(situation.incompatible)
    get = "gets" if kept == 1 else "get"
    others = f" {_counted(kept, 'worker')} {get} no jobs; `nocturne workers` says why." if kept else ""
    beside = situation.running - 1
    shared = f"shared with {_counted(beside, 'other render')}" if beside else "alone"
    running = f"It is running on {_counted(threads, 'worker thread')}, {shared}."
    return f"{running}{others}{end}{_unaudited(situation)}"


def _unaudited(situation: Situation) -> str:
    machines = machines_by_profile(situation.workers, situation.quarantined)
    needed = situation.render.floating_point_profile
    if (machines[needed] if needed else max(machines.values(), default=0)) > 1:
        return ""
    return " None of its ranges is audited: no second machine is there that could."


def _counted(number: int, name: str) -> str:
    return f"{number} {name}{'' if number == 1 else 's'}"


def _when(unix_time: float, now: float) -> str:
    stamp = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(unix_time))
    minutes = max(0.0, unix_time - now) / 60
    return (
        f"at {stamp}, in {minutes:.0f} minutes" if minutes < 120 else f"at {stamp}, in {minutes / 60:.0f} h"
    )
