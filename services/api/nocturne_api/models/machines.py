"""What a machine is told when it enrols."""

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Enrolment:
    """Fields as in the message of this name; gRPC only, as workers speak nothing else."""

    machine: str
    key: bytes = field(repr=False)
    redis_user: str
    redis_password: str = field(repr=False)
