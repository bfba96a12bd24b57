"""What happens to a service in mid-work. Each fault makes sure that it hits work in hand, or gives False."""

import time

from nocturne_coordinator.queue import keys

from tests.system.program import Program
from tests.system.renders import has_ended, is_in_mid_work
from tests.system.service_processes import LEASE_MS, ServiceProcesses
from tests.system.waiting import wait_for


def kill_worker(service: ServiceProcesses, render_id: str) -> bool:
    """SIGKILL for a worker that has a job in hand for certain: it is looked at while it stands still."""
    name, _ = _stopped_with_a_job(service, render_id)
    hit = not has_ended(service.client, render_id)
    service.kill_worker(name)
    service.start_worker()
    return hit


def stop_worker_for_three_leases(service: ServiceProcesses, render_id: str) -> bool:
    """SIGSTOP for a worker that has a job in hand; SIGCONT when another has long taken the job over."""
    name, victim = _stopped_with_a_job(service, render_id)
    held, begun = service.jobs_held_by(name), time.monotonic()
    wait_for(lambda: service.jobs_held_by(name) == [], "the job to be taken over")
    # Or the others would be through with everything before the three leases are over.
    others = [worker for each, worker in service.workers.items() if each != name]
    for worker in others:
        worker.pause()
    time.sleep(max(0.0, begun + 3 * LEASE_MS / 1000 - time.monotonic()))
    hit = held != [] and is_in_mid_work(service.client, render_id)
    for worker in (victim, *others):
        worker.go_on()
    return hit


def end_worker(service: ServiceProcesses, render_id: str) -> bool:
    """SIGTERM for a worker that has a job in hand: it ends in time and in order."""
    name, victim = _stopped_with_a_job(service, render_id)
    hit = not has_ended(service.client, render_id)
    victim.go_on()
    service.end_worker(name)
    service.start_worker()
    return hit


def kill_coordinator(service: ServiceProcesses, render_id: str) -> bool:
    """SIGKILL, and another start."""
    service.coordinator.kill()
    hit = is_in_mid_work(service.client, render_id)
    service.coordinator.start()
    return hit


def kill_redis(service: ServiceProcesses, render_id: str) -> bool:
    """SIGKILL, and another start, empty."""
    service.redis_server.kill()
    hit = is_in_mid_work(service.client, render_id)
    service.start_redis()
    return hit


def flush(service: ServiceProcesses, render_id: str) -> bool:
    """FLUSHALL while jobs are in flight: their number is read in the same transaction."""
    hit = False

    def flushed_with_jobs() -> bool:
        nonlocal hit
        if service.queue.xlen(keys.JOBS):
            with service.queue.pipeline(transaction=True) as transaction:
                jobs, _ok = transaction.xlen(keys.JOBS).flushall().execute()
            hit = int(jobs) > 0
        return hit or has_ended(service.client, render_id)

    wait_for(flushed_with_jobs, "jobs to be on their way")
    return hit


def deliver_waiting_results_again(service: ServiceProcesses, render_id: str) -> bool:
    """Copies of all results that are not committed yet, in reverse; there are some for certain."""

    def stands_still_with_results() -> bool:
        service.coordinator.pause()
        if service.queue.xlen(keys.RESULTS):
            return True
        service.coordinator.go_on()
        return has_ended(service.client, render_id)

    wait_for(stands_still_with_results, "results to wait for a commit")
    copied = service.deliver_again()
    service.coordinator.go_on()
    return copied != set()


def _stopped_with_a_job(service: ServiceProcesses, render_id: str) -> tuple[str, Program]:
    """A worker that stands still and has a job in hand for certain, or the render is over."""
    name, victim = next(iter(service.workers.items()))

    def stands_still_with_a_job() -> bool:
        victim.pause()
        if service.jobs_held_by(name):
            return True
        victim.go_on()
        return has_ended(service.client, render_id)

    wait_for(stands_still_with_a_job, f"{name} to be in mid-job")
    return name, victim


EVERY_FAULT = (kill_worker, kill_coordinator, kill_redis, flush, deliver_waiting_results_again)
