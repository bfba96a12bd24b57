"""Conditions that must hold after every fault."""

import json
import os
import time
from pathlib import Path

import redis
from nocturne_coordinator.queue import keys

from tests.coordinator.service import Service, check_complete, wait_until

SOME_DELAY = 0.06
"""Seconds per job: a fault hits a render in the middle, though commits are a second apart and the machine has
other things to do."""

BOUND_S = 15.0
"""Until work goes on: a lease, the longest pause before another try (2 s), the start of a process, a job and
a commit take some 4 s together; the rest is for machines that have other things to do."""

OVERDUE_SOON = ("--overdue-seconds", "1")
"""For the coordinator: instead of a minute, for jobs that vanish."""


def half_done(service: Service, render_id: str) -> bool:
    """Far enough for a fault to have something to spoil."""
    row = service.row(render_id)
    return row.ranges_done >= row.ranges_planned // 3


def check_survived(service: Service, *render_ids: str, redone: bool = False) -> None:
    """Counts equal the schedule, the image is that of a run without faults in every bit, Redis keeps
    nothing."""
    for render_id in render_ids:
        check_complete(service, render_id, redone)
    check_nothing_left(service)


def check_nothing_left(service: Service) -> None:
    """Neither job, result nor claim outlives the renders; all other keys lapse by themselves."""
    wait_until(lambda: _waiting(service) == (0, 0, 0))
    with service.server.client() as client:
        lasting = {name.decode() for name in client.scan_iter() if client.ttl(name) == -1}
    assert lasting <= {keys.JOBS, keys.QUICK_JOBS, keys.RESULTS}


def _waiting(service: Service) -> tuple[int, int, int] | None:
    """Jobs, results and claims; None while the group is being made again."""
    with service.server.client() as client:
        streams = keys.JOBS, keys.QUICK_JOBS
        try:
            claims = sum(client.xpending(stream, keys.WORKERS_GROUP)["pending"] for stream in streams)
        except redis.ResponseError:
            return None
        return sum(map(client.xlen, streams)), client.xlen(keys.RESULTS), claims


def check_resumes(service: Service, render_id: str, what: str, seconds: float = BOUND_S) -> None:
    """Another range is committed within that time; how long it took is noted."""
    begun, before = time.monotonic(), service.row(render_id).ranges_done
    assert before < service.row(render_id).ranges_planned, "the render was over before the fault"
    wait_until(lambda: service.row(render_id).ranges_done > before, seconds)
    note(what, resumed_s=time.monotonic() - begun)


def note(what: str, **figures: float) -> None:
    """For tests/faults/README.md: NOCTURNE_FIGURES names a file that gets a line of JSON."""
    path = os.environ.get("NOCTURNE_FIGURES")
    if path:
        with Path(path).open("a") as file:
            file.write(json.dumps({"what": what, **figures}) + "\n")
