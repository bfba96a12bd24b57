"""What happens to a service in mid-work. Each fault makes sure that it hits work in hand, or gives False."""

from nocturne_coordinator import keys

from tests.system.renders import has_ended, is_in_mid_work
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for


def kill_worker(service: ServiceProcesses, render_id: str) -> bool:
    """SIGKILL for a worker that has a job in hand for certain: it is looked at while it stands still."""
    name, victim = next(iter(service.workers.items()))

    def stands_still_with_a_job() -> bool:
        victim.pause()
        if service.jobs_held_by(name):
            return True
        victim.go_on()
        return has_ended(service.client, render_id)

    wait_for(stands_still_with_a_job, f"{name} to be in mid-job")
    hit = not has_ended(service.client, render_id)
    service.kill_worker(name)
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
    """FLUSHALL while jobs are on their way: their number is asked for in the same transaction."""
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


EVERY_FAULT = (kill_worker, kill_coordinator, kill_redis, flush, deliver_waiting_results_again)
