"""A PostgreSQL server of a test's own, on a Unix socket, which does not wait for its disk."""

import os
import pwd
import shutil
import subprocess
import tempfile
import time
from itertools import count
from pathlib import Path
from typing import Self

import psycopg
import pytest

_NUMBERS = count(1)


class PostgresServer:
    """One server with as many databases as wanted."""

    def __init__(self) -> None:
        """Skips where there is no PostgreSQL server."""
        programs = [path for path in Path("/usr/lib/postgresql").glob("*/bin") if (path / "initdb").exists()]
        if not programs:
            pytest.skip("needs a PostgreSQL server, such as Debian's package postgresql-15")
        self._programs = max(programs, key=lambda path: int(path.parent.name))
        self.version = int(self._programs.parent.name)
        # PostgreSQL does not run as root.
        self._user = "postgres" if os.geteuid() == 0 else pwd.getpwuid(os.geteuid()).pw_name
        self.folder = Path(tempfile.mkdtemp(prefix="nocturne-pg-"))
        shutil.chown(self.folder, self._user)
        self._data = self.folder / "data"
        self._run(
            "initdb", "-U", "nocturne", "--auth=trust", "--encoding=UTF8", "--locale=C.UTF-8", "--no-sync"
        )
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop("immediate")
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self) -> None:
        """Waits until it answers."""
        options = ["-c", "listen_addresses=", "-c", "fsync=off", "-c", "max_connections=200"]
        with (self.folder / "log").open("ab") as log:
            self._process = subprocess.Popen(
                [self._programs / "postgres", "-D", self._data, "-k", self.folder, *options],
                user=self._user if os.geteuid() == 0 else None,
                stdout=subprocess.DEVNULL,
                stderr=log,
                cwd=self.folder,
            )
        until = time.monotonic() + 60.0
        while True:
            try:
                psycopg.connect(self.url("postgres")).close()
                return
            except psycopg.OperationalError:
                if time.monotonic() > until:
                    raise
            time.sleep(0.05)

    def stop(self, how: str = "fast") -> None:
        """`immediate`: as if it were killed, with all that it holds."""
        if self._process is not None:
            self._run("pg_ctl", "stop", "-m", how, "-w", check=False)
            self._process.wait()
            self._process = None

    def url(self, database: str) -> str:
        """For libpq."""
        return f"postgresql://nocturne@/{database}?host={self.folder}"

    def make(self) -> str:
        """A new database; gives its URL."""
        name = f"n{next(_NUMBERS)}"
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}")
        return self.url(name)

    def _run(self, program: str, *words: str, check: bool = True) -> None:
        subprocess.run(
            [self._programs / program, "-D", self._data, *words],
            user=self._user if os.geteuid() == 0 else None,
            check=check,
            capture_output=True,
            cwd=self.folder,
        )
