"""What a worker says of itself, read with suspicion: it is shown, never trusted."""

import math

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.profiles import profile_of
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.limits import MAX_THREADS

_LARGEST = 2**63 - 1
_MAX_ID = 256


def worker_row(name: str, data: bytes, seen: float) -> WorkerRow | None:
    """A serialised WorkerStatus, found under that worker's name, as a row; None where it makes no sense."""
    try:
        status = job_pb2.WorkerStatus.FromString(data)
    except DecodeError:
        return None
    sensible = math.isfinite(status.photons_per_second) and math.isfinite(status.started)
    if not sensible or status.worker_id != name or not 1 <= len(name) <= _MAX_ID:
        return None
    return WorkerRow(
        id=status.worker_id,
        engine=status.engine,
        threads=min(status.threads, MAX_THREADS),
        photons=min(status.photons, _LARGEST),
        rays=min(status.rays, _LARGEST),
        photons_per_second=status.photons_per_second,
        jobs_done=min(status.jobs_done, _LARGEST),
        started=status.started,
        seen=seen,
        floating_point_profile=profile_of(status.floating_point_profile),
    )
