"""Lets only enrolled machines work through Redis, and accepts only results that they signed."""

from collections.abc import Mapping
from typing import Any

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator.enrolment import lease_of, redis_password, redis_user, refusal_of
from nocturne_coordinator.queue import keys

_USER_PREFIX = redis_user("")


class Guard:
    """The machines that are enrolled, and the secret of this folder's leases."""

    def __init__(self, lease_key: bytes, machines: Mapping[str, bytes]) -> None:
        """`machines`: keys by name."""
        self._lease_key = lease_key
        self.machines = machines
        self._admitted: dict[str, bytes] = {}

    def lease(self, job: bytes) -> bytes:
        """Of a serialised Job."""
        return lease_of(self._lease_key, job_pb2.Job.FromString(job))

    def refusal(self, data: bytes, machine: bytes, signed: bytes) -> str:
        """Why a result does not count that this machine is said to have signed so; empty: it does, or is no
        result at all."""
        try:
            result = job_pb2.JobResult.FromString(data)
        except DecodeError:
            return ""
        name = machine.decode(errors="replace")
        return refusal_of(result, data, name, signed, self.machines, self._lease_key)

    def admit(self, client: Any) -> None:
        """Makes Redis users of all machines, as they are, and ends the connections of those that are not any
        more."""
        there = {name.decode() for name in client.execute_command("ACL", "USERS")}
        pipeline = client.pipeline(transaction=False)
        # There may be thousands, of which one is new.
        for name, key in self.machines.items():
            if redis_user(name) not in there or self._admitted.get(name) != key:
                rules = _rules(name, redis_password(key))
                pipeline.execute_command("ACL", "SETUSER", redis_user(name), *rules)
        pipeline.execute()
        self._admitted = dict(self.machines)
        wanted = {redis_user(name) for name in self.machines}
        gone = [user for user in there if user.startswith(_USER_PREFIX) and user not in wanted]
        if gone:
            client.execute_command("ACL", "DELUSER", *gone)


def _rules(machine: str, password: str) -> list[str]:
    """The rights of a machine: take jobs, add results, report its workers' state, receive stop requests."""
    nothing = ("resetkeys", "resetchannels", "-@all")
    jobs = f"~{keys.JOBS} ~{keys.QUICK_JOBS}"
    parts = (
        f"{jobs} resetchannels -@all +xreadgroup +xautoclaim +xclaim +xpending +xack +xdel",
        f"%W~{keys.RESULTS} resetchannels -@all +xadd",
        f"%R~{keys.QUARANTINE_PREFIX}* %R~{keys.WITHDRAWN_PREFIX}* resetchannels -@all +mget",
        f"%W~{keys.WORKER_PREFIX}{machine}/* resetchannels -@all +set +del",
    )
    return [
        "reset",
        "on",
        f">{password}",
        *nothing,
        *("+ping", "+multi", "+exec", "+discard"),
        *(f"({part})" for part in parts),
    ]
