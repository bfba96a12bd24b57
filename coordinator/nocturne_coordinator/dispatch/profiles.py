"""Which workers may work on which renders: those of this engine that round as the render's other workers do.

Pure. Workers name their rounding by a digest (worker/src/rounding); a render has the class of its first
merged result, and no result of another class is ever added to it (docs/decisions/0034).
"""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.records import UNKNOWN_PROFILE, WorkerRow
from nocturne_coordinator.enrolment import machine_of, reason_of, token_of

_DIGEST = re.compile(r"[0-9a-f]{16}")

REDONE_SECONDS = 60.0
"""Work of an odd machine may be done again, if it takes a thread of each other so long, in all."""

_TO_DISCARD = 2
"""Machines that must round otherwise before anything is done again."""


def profile_of(told: str) -> str:
    """What a worker said of itself; all that say nothing, or nonsense, are of one class."""
    return told if _DIGEST.fullmatch(told) else UNKNOWN_PROFILE


def machines_by_profile(workers: Iterable[WorkerRow], quarantined: Mapping[str, str]) -> Counter[str]:
    """Of the workers that could take jobs."""
    found = _profiles(workers, quarantined)
    return Counter(floating_point_profile for floating_point_profile, _ in found)


def votes_by_profile(workers: Iterable[WorkerRow], quarantined: Mapping[str, str]) -> Counter[str]:
    """Whom the majority are. A machine counts once, whatever it says of itself: with threads or workers, one
    could outvote all others. So does an owner's token, if there are several: it may name many machines."""
    found = _profiles(workers, quarantined)
    owners = {(floating_point_profile, token_of(machine)) for floating_point_profile, machine in found}
    several = len({owner for _, owner in owners}) > 1
    return Counter(floating_point_profile for floating_point_profile, _ in (owners if several else found))


def _profiles(workers: Iterable[WorkerRow], quarantined: Mapping[str, str]) -> set[tuple[str, str]]:
    """All pairs of profile and machine."""
    return {
        (worker.floating_point_profile, machine_of(worker.id))
        for worker in workers
        if worker.engine == job_pb2.ENGINE_CURRENT and not reason_of(machine_of(worker.id), quarantined)
    }


def unaudited(workers: Iterable[WorkerRow], quarantined: Mapping[str, str]) -> dict[str, str]:
    """Workers whose results no other machine can audit, as none is there that rounds alike; and that in
    words."""
    workers = list(workers)
    machines = machines_by_profile(workers, quarantined)
    why = "Nothing that it traces is audited: no other machine is there that could."
    return {worker.id: why for worker in workers if machines[worker.floating_point_profile] == 1}


def usual_profiles(machines: Mapping[str, int]) -> set[str]:
    """What most machines have: several, where as many have each; none where there are no machines."""
    most = max(machines.values(), default=0)
    return {each for each, count in machines.items() if count == most}


def refusal_of(of_render: str, of_result: str, machines: Mapping[str, int]) -> str:
    """Why a result may not be merged into a render; empty: it may.

    Until something is merged (`of_render` is empty) it may not be of a rare class, or one odd worker that
    happened to be first would keep all others out.
    """
    if of_render:
        if of_result == of_render:
            return ""
        return f"floating-point profile {of_result}, the render has {of_render}"
    if not machines or max(machines.values()) <= machines.get(of_result, 0):
        return ""
    usual = " or ".join(sorted(usual_profiles(machines)))
    return f"floating-point profile {of_result}, most machines have {usual}"


def should_start_anew(of_render: str, machines: Mapping[str, int], cpu_seconds: float) -> bool:
    """Whether most machines can't help with a render, and would soon have repeated its work. The word of
    one discards nothing: it takes two.

    `cpu_seconds`: all that it has cost, so that this comes to an end.
    """
    most = max(machines.values(), default=0)
    others = most > machines.get(of_render, 0)
    return bool(of_render) and others and most >= _TO_DISCARD and cpu_seconds <= REDONE_SECONDS * most


def incompatible(
    workers: Collection[WorkerRow], quarantined: Mapping[str, str], renders: Collection[str]
) -> dict[str, str]:
    """The workers that are to take no jobs though they did nothing wrong, and why.

    `renders`: floating-point profiles of all open renders, empty for one that has none yet. Without any
    render, no floating-point profile is wrong.
    """
    usual = usual_profiles(votes_by_profile(workers, quarantined))
    wanted = {each for each in renders if each} | (usual if "" in renders else set())
    found = {}
    for worker in workers:
        if worker.engine != job_pb2.ENGINE_CURRENT:
            found[worker.id] = (
                f"It has engine {worker.engine}, and the service engine {int(job_pb2.ENGINE_CURRENT)}."
            )
        elif wanted and worker.floating_point_profile not in wanted:
            others = " and ".join(sorted(wanted))
            found[worker.id] = (
                f"It rounds otherwise: floating-point profile {worker.floating_point_profile}; "
                f"the open renders have {others}."
            )
    return found
