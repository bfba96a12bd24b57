"""A certificate that is renewed in its files is taken up by both endpoints, without a start."""

import datetime
import logging
import os
import re
import signal
import ssl
import subprocess
import sys
import time
from pathlib import Path

import grpc
import httpx
import pytest
import trustme
from nocturne_api import limits
from nocturne_api.addresses import AddressError
from nocturne_api.certificate import Certificate
from nocturne_api.service import Service, Settings

from tests.services.endpoints import started
from tests.services.served import served
from tests.system.free_ports import free_port_pair


def write(folder: Path, authority: trustme.CA, days: int = 30) -> tuple[Path, Path]:
    """A certificate and its key, in the same files each time."""
    until = datetime.datetime.now(datetime.UTC) + datetime.timedelta(days=days)
    made = authority.issue_cert("localhost", "127.0.0.1", not_after=until)
    files = folder / "tls.crt", folder / "tls.key"
    files[0].write_bytes(b"".join(each.bytes() for each in made.cert_chain_pems))
    files[1].write_bytes(made.private_key_pem.bytes())
    return files


def shown(port: int) -> str:
    """The certificate that a new connection gets."""
    return ssl.get_server_certificate(("127.0.0.1", port))


def serial(pem: Path) -> str:
    found = re.search("-----BEGIN.*?-----END CERTIFICATE-----", pem.read_text(), re.DOTALL)
    assert found
    return found[0]


def until_shown(port: int, pem: Path) -> None:
    end = time.monotonic() + 10
    while shown(port).strip() != serial(pem).strip():
        assert time.monotonic() < end, "the certificate was not taken up"
        time.sleep(0.05)


def asked(port: int, authority: trustme.CA) -> None:
    """gRPC by its own library, which trusts this authority alone."""
    trusted = grpc.ssl_channel_credentials(authority.cert_pem.bytes())
    with grpc.secure_channel(f"localhost:{port}", trusted) as channel:
        grpc.channel_ready_future(channel).result(5)


@pytest.fixture
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Settings:
    monkeypatch.setattr(limits, "CERTIFICATE_LOOK_S", 0.1)
    certificate, key = write(tmp_path, trustme.CA())
    return Settings(
        data=tmp_path / "data", web=tmp_path, port=0, grpc_port=0, tls_certificate=certificate, tls_key=key
    )


def test_one_that_is_renewed_in_place_is_taken_up(settings: Settings, tmp_path: Path) -> None:
    """By another authority, so that who trusts it alone gets in after it and not before."""
    with served(settings) as service:
        assert settings.tls_certificate is not None
        until_shown(service.port, settings.tls_certificate)
        newer = trustme.CA()
        with pytest.raises(grpc.FutureTimeoutError):
            asked(service.grpc_port, newer)
        write(tmp_path, newer)
        until_shown(service.port, settings.tls_certificate)
        until_shown(service.grpc_port, settings.tls_certificate)
        asked(service.grpc_port, newer)


def test_half_a_renewal_changes_nothing(
    settings: Settings, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert settings.tls_certificate is not None
    with served(settings) as service:
        before = shown(service.port)
        whole = (tmp_path / "tls.key").read_bytes()
        write(tmp_path, trustme.CA())
        new = (tmp_path / "tls.key").read_bytes()
        (tmp_path / "tls.key").write_bytes(whole)
        end = time.monotonic() + 10
        while "was not renewed" not in caplog.text:
            assert time.monotonic() < end
            time.sleep(0.05)
        assert shown(service.port) == before
        (tmp_path / "tls.key").write_bytes(new)
        until_shown(service.port, settings.tls_certificate)
        caplog.set_level(logging.INFO)


async def test_its_end_is_a_metric(settings: Settings, tmp_path: Path) -> None:
    write(tmp_path, trustme.CA(), days=3)
    async with started(settings) as service:
        text = await _metrics(service)
    found = re.search(r"^nocturne_certificate_expires (\S+)", text, re.MULTILINE)
    assert found
    assert float(found[1]) - time.time() == pytest.approx(3 * 86400, abs=600)


async def _metrics(service: Service) -> str:
    async with httpx.AsyncClient(verify=False, trust_env=False) as client:  # noqa: S501
        return (await client.get(f"https://127.0.0.1:{service.port}/metrics")).text


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("no certificate")
    with pytest.raises(AddressError, match="can't be used for TLS"):
        Certificate(tmp_path / "a", tmp_path / "a")


def test_sighup_reads_it_again_and_ends_nothing(tmp_path: Path) -> None:
    certificate, key = write(tmp_path, trustme.CA())
    port = free_port_pair()
    words = ["--data", str(tmp_path / "data"), "--port", str(port), "--grpc-port", str(port + 1)]
    tls = ["--tls-certificate", str(certificate), "--tls-key", str(key)]
    command = [sys.executable, "-m", "nocturne_api.main", *words, *tls]
    with subprocess.Popen(command) as api:
        try:
            end = time.monotonic() + 60
            while True:
                try:
                    shown(port)
                    break
                except OSError:
                    assert time.monotonic() < end
                    time.sleep(0.1)
            stamps = [(each, each.stat()) for each in (certificate, key)]
            write(tmp_path, trustme.CA())
            for path, before in stamps:
                # Only the signal says that it is new.
                os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
            api.send_signal(signal.SIGHUP)
            until_shown(port, certificate)
            assert api.poll() is None
        finally:
            api.terminate()
