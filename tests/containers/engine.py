"""A Docker Engine to build and run images with: the running one, or one that is started for a test.

Our own keeps its images in build/containers, so the next run builds only what changed. It takes root,
Debian's docker.io, and where the base image can't be pulled, mmdebstrap.
"""

import json
import os
import shutil
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
_FOLDER = ROOT / "build" / "containers"
_START_S = 60.0
_PULL_S = 60
_OWN_BASE = "nocturne-check/debian:bookworm"
_CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")


class Engine:
    """Calls docker and Compose, either version, on one engine."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.environment = {**os.environ, **environment}
        found = self._run(["docker", "compose", "version"], check=False).returncode == 0
        self._compose = ["docker", "compose"] if found else ["docker-compose"]
        if not found and shutil.which("docker-compose") is None:
            pytest.fail("there is no Compose: install docker-compose, or the plugin of docker")

    def docker(self, *words: str) -> str:
        """What docker prints; fails the test where it fails."""
        return self._run(["docker", *words]).stdout.strip()

    def compose(self, *words: str) -> str:
        """What Compose prints, on the file at the top of the repository."""
        return self._run([*self._compose, "--project-name", "nocturne-check", *words]).stdout.strip()

    def exec(self, container: str, *words: str) -> subprocess.CompletedProcess[str]:
        """Runs a program in a container."""
        return self._run(["docker", "exec", container, *words], check=False)

    def inspect(self, container: str) -> dict[str, Any]:
        """All that is known of a container."""
        found: dict[str, Any] = json.loads(self.docker("inspect", container))[0]
        return found

    def container(self, service: str, number: int = 1) -> str:
        """A service's container: its id."""
        labels = {"project": "nocturne-check", "service": service, "container-number": str(number)}
        filters = [f"--filter=label=com.docker.compose.{name}={value}" for name, value in labels.items()]
        return self.docker("ps", "--all", "--quiet", *filters)

    def versions(self) -> str:
        """For the record."""
        engine = self.docker("version", "--format", "{{.Server.Version}}")
        return f"Docker Engine {engine}, {self._run([*self._compose, 'version', '--short']).stdout.strip()}"

    def has_image(self, name: str) -> bool:
        return self._run(["docker", "image", "inspect", name], check=False).returncode == 0

    def _run(self, words: Sequence[str], check: bool = True) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            words, env=self.environment, cwd=ROOT, capture_output=True, text=True, check=False
        )
        if check and done.returncode != 0:
            end = "\n".join((done.stdout + done.stderr).splitlines()[-40:])
            pytest.fail(f"{' '.join(words)} ended with status {done.returncode}:\n{end}")
        return done


@contextmanager
def engine() -> Iterator[Engine]:
    """The running engine, or one that is started here, with a base image to build from."""
    with _answering() as environment:
        found = Engine(environment)
        found.environment["NOCTURNE_DEBIAN"] = os.environ.get("NOCTURNE_DEBIAN") or _base(found)
        yield found


@contextmanager
def _answering() -> Iterator[dict[str, str]]:
    if shutil.which("docker") is None:
        pytest.fail("there is no docker: install docker.io")
    if _answers({}):
        yield {}
        return
    if os.geteuid() != 0 or shutil.which("dockerd") is None:
        pytest.fail("no Docker Engine answers; start one, or install docker.io and run this as root")
    _FOLDER.mkdir(parents=True, exist_ok=True)
    # Unix sockets have short names.
    socket = Path("/tmp") / f"nocturne-check-{os.getpid()}.sock"  # noqa: S108 - root's, with its number
    places = {"--data-root": "data", "--exec-root": "exec", "--pidfile": "pid"}
    options = [f"{option}={_FOLDER / name}" for option, name in places.items()]
    with (_FOLDER / "dockerd.log").open("ab") as log:
        process = subprocess.Popen(["dockerd", *options, f"--host=unix://{socket}"], stdout=log, stderr=log)
    environment = {"DOCKER_HOST": f"unix://{socket}"}
    try:
        end = time.monotonic() + _START_S
        while not _answers(environment):
            if process.poll() is not None or time.monotonic() > end:
                pytest.fail(f"dockerd did not start; see {_FOLDER / 'dockerd.log'}")
            time.sleep(0.2)
        yield environment
    finally:
        process.terminate()
        process.wait()


def _answers(environment: Mapping[str, str]) -> bool:
    asked = ["docker", "version", "--format", "{{.Server.Version}}"]
    done = subprocess.run(asked, env={**os.environ, **environment}, capture_output=True, check=False)
    return done.returncode == 0


def _base(engine: Engine) -> str:
    """The image that the Dockerfile names, or one like it that is made of Debian's archive."""
    dockerfile = (ROOT / "deploy" / "Dockerfile").read_text()
    pinned = dockerfile.split("ARG DEBIAN=")[1].split()[0]
    if not engine.has_image(pinned):
        try:
            words = ["docker", "pull", pinned]
            subprocess.run(words, env=engine.environment, check=True, capture_output=True, timeout=_PULL_S)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
            _make_base(engine)
            return _OWN_BASE
    return pinned


def _make_base(engine: Engine) -> None:
    """A minimal Debian with the authorities that this machine believes: pip and npm ask them in builds."""
    if engine.has_image(_OWN_BASE):
        return
    if shutil.which("mmdebstrap") is None:
        pytest.fail("the base image can't be pulled; install mmdebstrap to make one like it")
    folder = _FOLDER / "base"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    key = "[signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]"
    sources = [
        f"deb {key} http://deb.debian.org/debian bookworm main",
        f"deb {key} http://security.debian.org/debian-security bookworm-security main",
    ]
    make = ["mmdebstrap", "--variant=minbase", "--mode=root", "bookworm", str(folder / "root.tar"), *sources]
    subprocess.run(make, check=True, capture_output=True)
    engine.docker("import", str(folder / "root.tar"), "nocturne-check/root")
    (folder / "root.tar").unlink()
    local = sorted(Path("/usr/local/share/ca-certificates").glob("*.crt"))
    for certificate in (_CERTIFICATES, *local):
        shutil.copy(certificate, folder / certificate.name)
    (folder / "Dockerfile").write_text(
        "FROM nocturne-check/root\n"
        "COPY *.crt /usr/local/share/ca-certificates/\n"
        f"COPY {_CERTIFICATES.name} {_CERTIFICATES}\n"
        f"ENV PIP_CERT={_CERTIFICATES} SSL_CERT_FILE={_CERTIFICATES} NODE_EXTRA_CA_CERTS={_CERTIFICATES}\n"
    )
    engine.docker("build", "--quiet", "--tag", _OWN_BASE, str(folder))
