"""One owner who plays every known trick at once costs the others nothing: SOAK_SECONDS, 600 unless given;
SOAK_SEED repeats a run."""

import os
import random
import time
from pathlib import Path

import httpx
import pytest
from nocturne_coordinator.store.data_folder import DataFolder

from tests.faults.survival import note
from tests.faults.tricks import Trickster, seconds_of_a_small_render
from tests.system.up import Up

pytestmark = [
    pytest.mark.soak,
    pytest.mark.system,
    pytest.mark.xfail(
        strict=False, reason="jobs take up to a minute, and others wait behind them: over 120 s were seen"
    ),
]

_MOST_S = 3.0


def test_another_owners_small_render_ends_within_seconds_whatever_one_owner_does(tmp_path: Path) -> None:
    """P16: at any moment, on two cores."""
    seed = int(os.environ.get("SOAK_SEED", random.SystemRandom().randrange(2**32)))
    print(f"SOAK_SEED={seed}")  # noqa: T201 - to run it again
    options = ("--auth", "--webhook-network", "127.0.0.1/32")
    with Up(tmp_path, 1, 2, *options) as service:
        folder = DataFolder(service.data)
        tokens = [folder.tokens.create(name, ["submit"]) for name in ("mallory", "bob")]
        folder.close()
        mallory = Trickster(service.url, service.grpc, tokens[0], seed)
        headers = {"Authorization": f"Bearer {tokens[1]}"}
        waits: list[float] = []
        end = time.monotonic() + float(os.environ.get("SOAK_SECONDS", "600"))
        with mallory.at_work(), httpx.Client(base_url=service.url, headers=headers, timeout=120) as bob:
            while time.monotonic() < end:
                waits.append(seconds_of_a_small_render(bob, len(waits)))
                time.sleep(1.0)
        waits.sort()
        median, most = waits[len(waits) // 2], waits[-1]
        note(
            "P16",
            seed=seed,
            renders=len(waits),
            median_s=median,
            most_s=most,
            tricks=sum(mallory.done.values()),
        )
        print(f"{len(waits)} renders, median {median:.2f} s, most {waits[-5:]} s; {mallory.done}")  # noqa: T201
        assert most <= _MOST_S
