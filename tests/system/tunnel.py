"""Both ends of the tunnel for Redis, as deploy/stunnel starts them, with certificates made for it."""

import shutil
import socket
from pathlib import Path

import pytest
import trustme

from tests.system.program import Program
from tests.system.waiting import wait_for

START = Path(__file__).parents[2] / "deploy" / "stunnel" / "start.sh"
NAME = "redis.night.example"

needs_stunnel = pytest.mark.skipif(
    shutil.which("stunnel") is None, reason="stunnel is not installed: apt-get install stunnel4"
)


def certificate(authority: trustme.CA, folder: Path, *names: str) -> tuple[Path, Path]:
    """Certificate and key of `names`, in files."""
    issued = authority.issue_cert(*names)
    certificate, key = folder / f"{names[0]}.pem", folder / f"{names[0]}.key"
    issued.cert_chain_pems[0].write_to_path(certificate)
    issued.private_key_pem.write_to_path(key)
    return certificate, key


def authority_file(authority: trustme.CA, folder: Path, name: str = "authority.pem") -> Path:
    path = folder / name
    authority.cert_pem.write_to_path(path)
    return path


def tunnel_end(
    end: str,
    folder: Path,
    accept: int,
    connect: str,
    pair: tuple[Path, Path],
    authority: Path,
    name: str = NAME,
) -> Program:
    """Started, and listening."""
    environment = {
        "NOCTURNE_TUNNEL_ACCEPT": f"127.0.0.1:{accept}",
        "NOCTURNE_TUNNEL_CONNECT": connect,
        "NOCTURNE_TUNNEL_CERTIFICATE": str(pair[0]),
        "NOCTURNE_TUNNEL_KEY": str(pair[1]),
        "NOCTURNE_TUNNEL_AUTHORITY": str(authority),
        "NOCTURNE_TUNNEL_NAME": name,
        "TMPDIR": str(folder),
    }
    program = Program([START, end], folder / f"tunnel-{end}-{accept}.log", environment)
    program.start()

    def listens() -> bool:
        assert program.is_alive(), program.tail()
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", accept)) == 0

    wait_for(listens, f"the tunnel's {end}")
    return program
