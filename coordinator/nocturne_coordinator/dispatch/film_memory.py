"""The memory that films take, and how much of it there is. Pure."""

from nocturne.v1 import job_pb2
from nocturne_scene.tile_sums import sums_per_pixel

from nocturne_coordinator import limits

_NUMBER_BYTES = 8


def numbers_of(schedule: job_pb2.RangeSchedule) -> int:
    """Numbers in a render's sums: its film's, and with forward photons theirs and those of both together."""
    films = 3 if schedule.photon_range_ends else 1
    of_pixel = sums_per_pixel(len(schedule.further_responses)) + schedule.coefficients
    return films * schedule.width * schedule.height * of_pixel


def max_numbers(memory: int) -> int:
    """Numbers that an owner's renders may hold where no other owner has any; `memory` in bytes, 0:
    unknown."""
    of_memory = int(limits.SUMS_PART_OF_MEMORY * memory / _NUMBER_BYTES / 2)
    return min(limits.MAX_RUNNING_SUMS, of_memory) if memory else limits.MAX_RUNNING_SUMS


def why_too_large(schedule: job_pb2.RangeSchedule, memory: int) -> str:
    """Why so much memory can never hold a film and what makes its pictures; empty: it can."""
    needed = 2 * _NUMBER_BYTES * numbers_of(schedule) + limits.MEMORY_BESIDE
    needed += limits.PICTURE_BYTES * schedule.width * schedule.height
    if not memory or needed <= memory:
        return ""
    return (
        f"A film of {schedule.width} x {schedule.height} needs {needed / 2**30:.1f} GiB of memory where the "
        f"coordinator runs, and there are {memory / 2**30:.1f} GiB: render a smaller one, or give the "
        "coordinator more."
    )
