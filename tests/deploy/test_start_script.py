"""deploy/redis/start.sh and the health checks, asked from another machine: as containers meet them."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from nocturne_coordinator.queue import keys

from tests.coordinator.service import wait_until
from tests.deploy.network import OtherMachine, other_machine
from tests.system.free_ports import free_port_pair

DEPLOY = Path(__file__).parents[2] / "deploy"
_ANY_ADDRESS = "0.0.0.0"  # noqa: S104 - what is tested
PASSWORDS = {"coordinator": "the first/word&"}


@dataclass
class Started:
    """Redis on this machine, and a machine that reaches it by the network alone."""

    process: subprocess.Popen[bytes]
    port: int
    other: OtherMachine
    folder: Path
    """For its files, and temporary ones."""

    def cli(self, role: str, *words: str) -> str:
        """What redis-cli prints there, as a role or, with an empty name, as nobody."""
        who = ["--user", role, "--pass", PASSWORDS[role], "--no-auth-warning"] if role else []
        address = ["-h", self.other.us, "-p", str(self.port)]
        done = self.other.run("redis-cli", *address, *who, *words)
        return (done.stdout + done.stderr).strip()

    def check(self, script: str, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """A health check, run there."""
        settings = [f"{name}={value}" for name, value in environment.items()]
        return self.other.run("env", *settings, str(DEPLOY / "health" / script), *words)


@pytest.fixture(scope="module")
def started(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Started]:
    folder = tmp_path_factory.mktemp("redis")
    with other_machine() as other:
        port = free_port_pair()
        # As the compose file and Kubernetes give them.
        process = subprocess.Popen(
            [
                DEPLOY / "redis" / "start.sh",
                "--bind",
                _ANY_ADDRESS,
                "--port",
                str(port),
                "--dir",
                str(folder),
            ],
            env={
                "PATH": os.defpath,
                "TMPDIR": str(folder),
                **{f"NOCTURNE_REDIS_{role.upper()}_PASSWORD": word for role, word in PASSWORDS.items()},
            },
            stdout=subprocess.DEVNULL,
        )
        redis = Started(process, port, other, folder)
        try:
            wait_until(lambda: redis.check("redis-answers.sh", other.us, str(port)).returncode == 0, 20.0)
            yield redis
        finally:
            process.kill()
            process.wait()


def test_nothing_of_users_and_passwords_is_left_in_a_file(started: Started) -> None:
    """Nor where it could be read while Redis runs."""
    assert list(started.folder.iterdir()) == []
    arguments = Path(f"/proc/{started.process.pid}/cmdline").read_bytes()
    environment = Path(f"/proc/{started.process.pid}/environ").read_bytes()
    assert PASSWORDS["coordinator"].encode() not in arguments + environment


def test_the_coordinator_reaches_redis_over_the_network(started: Started) -> None:
    assert started.cli("coordinator", "SET", keys.SESSION, "folder:1", "EX", "60") == "OK"
    assert started.cli("coordinator", "GET", keys.SESSION) == "folder:1"


def test_a_stranger_gets_nothing_over_the_network(started: Started) -> None:
    assert "NOAUTH" in started.cli("", "PING")
    assert "NOAUTH" in started.cli("", "EXISTS", keys.SESSION)
    assert "WRONGPASS" in started.cli("", "AUTH", "machine-m", PASSWORDS["coordinator"])
    assert "WRONGPASS" in started.cli("", "AUTH", "default", "")


def test_redis_that_hangs_does_not_answer(started: Started) -> None:
    address = (started.other.us, str(started.port))
    assert started.check("redis-answers.sh", *address).returncode == 0
    started.process.send_signal(signal.SIGSTOP)
    try:
        hanging = started.check("redis-answers.sh", *address)
    finally:
        started.process.send_signal(signal.SIGCONT)
    assert (hanging.returncode, hanging.stdout) == (1, "Redis does not answer\n")


def _check(script: str, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([DEPLOY / "health" / script, *words], capture_output=True, text=True, check=False)


def test_a_file_is_fresh_for_some_seconds(tmp_path: Path) -> None:
    file = tmp_path / "alive"
    assert _check("is-fresh.sh", str(file), "30").stdout == f"{file}: not there yet\n"
    file.touch()
    assert _check("is-fresh.sh", str(file), "30").returncode == 0
    os.utime(file, (time.time() - 40.0, time.time() - 40.0))
    assert _check("is-fresh.sh", str(file), "30").returncode == 1


def test_passwords_are_made_once_and_for_their_owner(tmp_path: Path) -> None:
    files = [tmp_path / "coordinator", tmp_path / "worker"]
    make = [DEPLOY / "secrets" / "make-passwords.sh", *files]
    subprocess.run(make, check=True, capture_output=True)
    made = [file.read_text() for file in files]
    # 32 random bytes each.
    assert [len(word) for word in made] == [43, 43]
    assert made[0] != made[1]
    assert {file.stat().st_mode & 0o777 for file in files} == {0o600}
    subprocess.run(make, check=True, capture_output=True)
    assert [file.read_text() for file in files] == made


def test_secrets_come_from_files_into_one_environment(tmp_path: Path) -> None:
    file = tmp_path / "password"
    file.write_text("a word with $ and 'quotes'")
    wrapper = str(DEPLOY / "secrets" / "with-secrets.sh")
    show = [sys.executable, "-c", "import os; print(os.environ['NOCTURNE_REDIS_PASSWORD'])"]
    environment = {"PATH": os.defpath, "NOCTURNE_REDIS_PASSWORD_FILE": str(file)}
    done = subprocess.run([wrapper, *show], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == file.read_text() + "\n"
    file.unlink()
    failed = subprocess.run([wrapper, *show], env=environment, capture_output=True, text=True, check=False)
    assert failed.returncode == 2
    assert f"NOCTURNE_REDIS_PASSWORD_FILE: can't read {file}" in failed.stderr


def test_tokens_are_made_anew_for_a_new_data_folder_only(tmp_path: Path) -> None:
    def make(data: str) -> str:
        pairs = [f"{scope}={tmp_path / scope}" for scope in ("worker", "read")]
        path = f"{Path(sys.executable).parent}:{os.defpath}"
        environment = {**os.environ, "PATH": path}
        script = str(DEPLOY / "secrets" / "make-tokens.sh")
        subprocess.run(
            [script, str(tmp_path / data), *pairs], check=True, capture_output=True, env=environment
        )
        return (tmp_path / "worker").read_text()

    first = make("data")
    assert first.startswith("nct_")
    assert make("data") == first
    assert make("another") != first
    assert (tmp_path / "worker").stat().st_mode & 0o777 == 0o600
    assert (tmp_path / "read").stat().st_mode & 0o777 == 0o444
