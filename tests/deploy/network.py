"""Another machine for a test: a network namespace with its own address, joined to this one by a cable."""

import os
import secrets
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import pytest


@dataclass(frozen=True)
class OtherMachine:
    """Programs that `command` starts see us at the address `us`, and have the address `there`."""

    name: str
    us: str
    there: str

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """Runs a program there."""
        return subprocess.run(
            ["ip", "netns", "exec", self.name, *command],
            capture_output=True,
            text=True,
            timeout=30,
            check=False,
        )


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


@contextmanager
def other_machine() -> Iterator[OtherMachine]:
    """Skips the test where namespaces can't be made: that takes root, in a container CAP_NET_ADMIN too."""
    name = f"nocturne-{os.getpid()}-{secrets.token_hex(2)}"
    cable = f"noc{secrets.token_hex(4)}"
    # Link-local, so no route of a real network conflicts (RFC 3927); a pair of addresses of one /30.
    third, fourth = secrets.randbelow(254) + 1, 4 * secrets.randbelow(63)
    us, there = f"169.254.{third}.{fourth + 1}", f"169.254.{third}.{fourth + 2}"
    try:
        _ip("netns", "add", name)
    except (OSError, subprocess.CalledProcessError) as trouble:
        said = getattr(trouble, "stderr", "") or trouble
        pytest.skip(f"no network namespace can be made here: {said}".strip())
    try:
        _make_cable(name, cable, us, there)
        yield OtherMachine(name, us, there)
    finally:
        _ip("netns", "delete", name)


def _make_cable(name: str, cable: str, us: str, there: str) -> None:
    steps: Sequence[Sequence[str]] = (
        ("link", "add", f"{cable}a", "type", "veth", "peer", "name", f"{cable}b", "netns", name),
        ("addr", "add", f"{us}/30", "dev", f"{cable}a"),
        ("link", "set", f"{cable}a", "up"),
        ("-n", name, "addr", "add", f"{there}/30", "dev", f"{cable}b"),
        ("-n", name, "link", "set", f"{cable}b", "up"),
    )
    for step in steps:
        _ip(*step)
