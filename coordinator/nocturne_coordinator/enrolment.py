"""What tells machines apart, and results of jobs that were given out from others (docs/decisions/0047). Pure.

A machine has a key, from which its password for Redis follows. A job on the stream has a lease, a secret that
only who took the job has read. A result is signed with both.
"""

import hashlib
import hmac
from collections.abc import Mapping

from nocturne.v1 import job_pb2

KEY_BYTES = 32
_LEASE_BYTES = 16

SEPARATOR = "/"
"""Between a machine and the name of one of its workers."""

NODE_SEPARATOR = ":"
"""Between the name of a token and that of a machine, where several enrol with it."""


def machine_of(worker: str) -> str:
    """Whose a worker is; a worker that did not enrol counts as a separate machine."""
    return worker.partition(SEPARATOR)[0]


def token_of(machine: str) -> str:
    """Whose a machine is: all that enrolled with one token have one owner, who may give them any names."""
    return machine.partition(NODE_SEPARATOR)[0]


def reason_of(machine: str, reasons: Mapping[str, str]) -> str:
    """The reason given there for the machine or its token; empty: none."""
    return (reasons.get(machine) or reasons.get(token_of(machine), "")) if reasons else ""


def redis_user(machine: str) -> str:
    """A machine's name for Redis."""
    return f"machine-{machine}"


def redis_password(key: bytes) -> str:
    """A machine's password for Redis."""
    return hmac.digest(key, b"redis", hashlib.sha256).hex()


def lease_of(lease_key: bytes, job: job_pb2.Job) -> bytes:
    """The secret of a job: the same whenever the job is given out, so that none has to be remembered."""
    text = f"{job.render_id}/{job.tile_index}/{job.first_sample}/{job.end_sample}"
    return hmac.digest(lease_key, text.encode(), hashlib.sha256)[:_LEASE_BYTES]


def signature(machine_key: bytes, lease: bytes, result: bytes) -> bytes:
    """Of a serialised JobResult, by the machine that had the job's lease."""
    return hmac.digest(machine_key, lease + result, hashlib.sha256)


def refusal_of(
    result: job_pb2.JobResult,
    data: bytes,
    machine: str,
    signed: bytes,
    keys: Mapping[str, bytes],
    lease_key: bytes,
) -> str:
    """Why a result does not count, by the fields stored with it on the stream; empty: it does.

    `data`: the result as it came; `keys`: of the machines that are enrolled.
    """
    key = keys.get(machine)
    if key is None:
        return "it is of no machine that is enrolled"
    if not hmac.compare_digest(signature(key, lease_of(lease_key, result.job), data), signed):
        return f"machine={machine} has not signed it, or never had the job"
    if machine_of(result.worker_id) != machine:
        return f"machine={machine} signed it in the name of another"
    return ""
