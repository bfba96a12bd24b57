"""Units of systemd, and the commands of the deployment page that make certificates."""

import re
import shlex
import shutil
import socket
import ssl
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from nocturne_api import main as api_main
from nocturne_client.local.programs import need_program
from nocturne_coordinator import main as coordinator_main

ROOT = Path(__file__).parents[2]
UNITS = sorted((ROOT / "deploy" / "systemd").glob("*.service"))
_INSTALLED = "/opt/nocturne/"

needs_systemd = pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="there is no systemd")


def words_of(unit: str) -> list[str]:
    """What a unit starts."""
    text = (ROOT / "deploy" / "systemd" / f"nocturne-{unit}.service").read_text()
    (command,) = re.findall(r"^ExecStart=(.*)$", text, re.MULTILINE)
    return shlex.split(command)


@needs_systemd
def test_systemd_takes_the_units(tmp_path: Path) -> None:
    for unit in UNITS:
        text = re.sub(r"^(ExecStart=)\S+", r"\1/bin/true", unit.read_text(), flags=re.MULTILINE)
        (tmp_path / unit.name).write_text(text.replace("User=nocturne", "User=root"))
    said = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", *(tmp_path / unit.name for unit in UNITS)],
        capture_output=True,
        text=True,
        check=False,
    )
    ours = [line for line in said.stderr.splitlines() if "nocturne" in line]
    assert (said.returncode, ours) == (0, [])


def test_our_programs_understand_what_the_units_say(monkeypatch: pytest.MonkeyPatch) -> None:
    redis = ROOT / words_of("redis")[0].removeprefix(_INSTALLED)
    assert redis.stat().st_mode & 0o100
    program, *words = words_of("coordinator")
    assert program == f"{_INSTALLED}.venv/bin/nocturne-coordinator"
    assert coordinator_main._parser().parse_args(words).enrolled
    monkeypatch.setattr(sys, "argv", words_of("api"))
    settings = api_main._settings()
    assert settings.auth
    assert settings.tls_certificate is not None
    assert settings.data == Path("/var/lib/nocturne")
    known = subprocess.run(
        [need_program("nocturne-worker"), "--help"], check=True, capture_output=True, text=True
    )
    for word in words_of("worker"):
        assert not word.startswith("--") or f"{word} " in known.stdout, word


def test_the_pages_commands_make_certificates(tmp_path: Path) -> None:
    """That the API can show by the names that it is called by, and by no others."""
    page = (ROOT / "docs" / "how-to" / "machines.md").read_text()
    (commands,) = [
        block for block in re.findall(r"^```sh\n(.*?)^```$", page, re.M | re.S) if "openssl" in block
    ]
    subprocess.run(["bash", "-euc", commands], cwd=tmp_path, check=True, capture_output=True)
    made = {path.name for path in tmp_path.iterdir()}
    assert made == {
        f"{name}.{kind}" for name in ("authority", "api", "redis", "worker") for kind in ("pem", "key")
    }
    assert all(path.stat().st_mode & 0o77 == 0 for path in tmp_path.glob("*.key"))
    caller = ssl.create_default_context(cafile=tmp_path / "authority.pem")
    assert _greets(tmp_path, caller, "api.example") == "TLSv1.3"
    assert _greets(tmp_path, caller, "10.0.0.1") == "TLSv1.3"
    with pytest.raises(ssl.SSLCertVerificationError, match="not valid for"):
        _greets(tmp_path, caller, "other.example")
    with pytest.raises(ssl.SSLCertVerificationError, match="unable to get local issuer"):
        _greets(tmp_path, ssl.create_default_context(), "api.example")


def _greets(folder: Path, caller: ssl.SSLContext, name: str) -> str | None:
    """The version of TLS by which a caller and the API's certificate agree."""
    server = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    server.load_cert_chain(folder / "api.pem", folder / "api.key")
    ours, theirs = socket.socketpair()

    def serve() -> None:
        try:
            server.wrap_socket(theirs, server_side=True).close()
        except OSError:
            theirs.close()

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        with ours, caller.wrap_socket(ours, server_hostname=name) as connection:
            return connection.version()
    finally:
        thread.join()
