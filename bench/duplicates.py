"""Processor time of workers that no image got: without faults, and with workers killed again and again.

Time is scaled by 60, so that minutes stand for a night: a job takes 0.5 s for 30 s, a lease 1/6 s for 10 s,
and each worker is killed every 10 s, not every ten minutes, and is back at once. The coordinator's own waits
are not scaled: it looks at workers every second, as if that were a minute. Audits are off: their second
results are intended.
"""

import time

from bench.report import Figures, Row, significant
from bench.scale import farm, fleet

SCALE = 60.0
JOB_S, LEASE_S, KILLED_S = 30.0, 10.0, 600.0
WORKERS = 40
"""The forty borrowed machines, with one thread each."""

AIM, AIM_KILLED = 0.01, 0.05


def run(quick: bool) -> Figures:
    """Both in turn, each on a new farm."""
    seconds = 10.0 if quick else 60.0
    return {
        "scale": SCALE,
        "workers": WORKERS,
        "undisturbed": _wasted(seconds, 0.0),
        "killed": _wasted(seconds, KILLED_S / SCALE),
    }


def rows(figures: Figures) -> list[Row]:
    """The parts."""
    undisturbed, killed = figures["undisturbed"], figures["killed"]
    return [
        Row("work that no image got, without faults", f"{undisturbed['wasted']:.2%}", f"below {AIM:.0%}"),
        Row(
            f"the same, each worker killed every ten minutes ({killed['died']} times), jobs of 30 s",
            f"{killed['wasted']:.2%}",
            f"below {AIM_KILLED:.0%}",
        ),
    ]


def _wasted(seconds: float, killed_s: float) -> Figures:
    """Work of the workers that was not merged, without their unfinished jobs at the end."""
    audits = ("--audit-share", "0", "--audit-share-new", "0")
    with farm(*audits) as service:
        with fleet(service.url, WORKERS, JOB_S / SCALE, LEASE_S / SCALE, killed_s) as said:
            time.sleep(seconds)
        # All that is sent is committed.
        time.sleep(5.0)
        merged, waiting = service.merged_cpu_s(), service.waiting_cpu_s()
        aside = service.failed_tiles()
    return {
        "died": said["died"],
        "worked_s": significant(said["worked_s"]),
        "merged_s": significant(merged),
        "waiting_s": significant(waiting),
        "wasted": significant(1.0 - (merged + waiting) / said["worked_s"]),
        "failed_tiles": aside,
    }
