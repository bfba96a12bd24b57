"""`nocturne up`: the whole service as children of one process, on one data folder."""

import fcntl
import json
import os
import signal
import socket
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from nocturne_coordinator.signals import on_signals
from nocturne_coordinator.socket_folder import socket_folder
from nocturne_coordinator.store.privacy import make_private
from nocturne_scene.errors import NocturneError
from nocturne_scene.replacing import replacing
from rich.markup import escape
from rich.panel import Panel

from nocturne_client.console import CONSOLE, ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local import kept_logs
from nocturne_client.local.children import Child
from nocturne_client.local.probes import api_answers, is_fresh, redis_answers, worker_is_heard_of
from nocturne_client.local.programs import need_program
from nocturne_client.local.tokens import first_token

# Twenty times the duration on an idle machine.
_START_S = 120.0
# A worker finishes or hands back its job; the others have nothing that takes long.
_GRACE_S = 5.0
_TEND_S = 0.2
LOCK = "service.lock"
"""In the data folder: who runs a service there holds it."""
# An empty database with its log, and first lines of logs.
_PROBE_BYTES = 2**20


@dataclass(frozen=True)
class UpSettings:
    """Data folder, port of page and REST (gRPC is one above), worker processes, threads of each."""

    data: Path
    port: int
    workers: int
    threads: int
    auth: bool = False
    """Callers need a token."""
    api_options: Mapping[str, str] = field(default_factory=dict)
    """Where they are not its defaults: what owners and the data folder may have, what an hour costs, where
    webhooks may lead."""


def run_up(settings: UpSettings) -> None:
    """Runs until SIGINT or SIGTERM, then stops all in order. SIGHUP replaces the logs and notifies the
    children, unless it says that the terminal is closed. NocturneClientError if it can't start."""
    stop, reload = threading.Event(), threading.Event()
    has_terminal = os.isatty(0)

    def hung_up() -> None:
        (stop if has_terminal and not os.isatty(0) else reload).set()

    on_signals({signal.SIGHUP: hung_up, signal.SIGINT: stop.set, signal.SIGTERM: stop.set})
    with _told(settings.data):
        _make_folder(settings.data)
        _run(settings, stop, reload)


def _run(settings: UpSettings, stop: threading.Event, reload: threading.Event) -> None:
    with only_one_service(settings.data), socket_folder() as sockets:
        need_program("nocturne-worker")
        _check_ports(settings.port)
        token = first_token(settings.data) if settings.auth else None
        with _Stack(settings, Path(sockets)) as stack:
            stack.start(stop)
            if not stop.is_set():
                _announce(settings, token)
            while not stop.wait(_TEND_S):
                if reload.is_set():
                    reload.clear()
                    stack.reload()
                stack.supervise()
            ERRORS.print("stopping ...")


class _Stack:
    """All children. The sockets between them lie in a folder of mode 0700, so no other user can connect."""

    def __init__(self, settings: UpSettings, sockets: Path) -> None:
        self._settings = settings
        self._file = settings.data / "service.json"
        self._redis_socket = sockets / "redis.sock"
        self._logs = settings.data / "logs"
        self._logs.mkdir(exist_ok=True)
        for log in self._logs.glob("*.log"):
            kept_logs.begin(log)
        redis_url = f"unix://{self._redis_socket}"
        grpc_socket = sockets / "grpc.sock"
        redis, port, alive = self._redis_socket, settings.port, sockets / "coordinator.alive"
        self._redis = self._child("redis", lambda: redis_answers(redis), *_redis_command(redis))
        python = (sys.executable, "-m")
        data = ("--data", str(settings.data))
        self._coordinator = self._child(
            "coordinator",
            lambda: is_fresh(alive),
            *(*python, "nocturne_coordinator.main", *data, "--redis", redis_url, "--alive", str(alive)),
        )
        ports = ("--port", str(port), "--grpc-port", str(port + 1))
        self._api = self._child(
            "api",
            lambda: api_answers(port),
            *(*python, "nocturne_api.main", *data, *ports, "--grpc-unix", str(grpc_socket)),
            *(["--auth"] if settings.auth else []),
            *(word for option, value in settings.api_options.items() for word in (option, value)),
        )
        self._workers = [
            self._child(
                f"worker-{number}",
                partial(worker_is_heard_of, redis, f"worker-{number}"),
                str(need_program("nocturne-worker")),
                *("--redis", redis_url),
                *("--assets", f"unix:{grpc_socket}"),
                *("--cache", str(settings.data / "cache")),
                *("--threads", str(settings.threads)),
                *("--id", f"worker-{number}"),
            )
            for number in range(1, settings.workers + 1)
        ]
        self._children = [self._redis, self._coordinator, self._api, *self._workers]

    def __enter__(self) -> "_Stack":
        return self

    def __exit__(self, *_: object) -> None:
        with ExitStack() as last_to_first:
            for child in self._children:
                last_to_first.callback(child.stop, _GRACE_S)
        self._file.unlink(missing_ok=True)

    def start(self, stop: threading.Event) -> None:
        """Starts all in order, each when the children it needs answer; ends early when `stop` is set."""
        self._redis.start()
        self._redis.wait_until(lambda: stop.is_set() or redis_answers(self._redis_socket), _START_S)
        self._coordinator.start()
        self._api.start()
        self._api.wait_until(
            lambda: stop.is_set() or api_answers(self._settings.port, "/readyz?exclude=merging"), _START_S
        )
        if not self._coordinator.is_alive():
            raise NocturneClientError(f"coordinator did not start. {self._coordinator.tail()}")
        for worker in self._workers:
            worker.start()
        self._write_file()

    def supervise(self) -> None:
        """Starts children again that have died, or hang; bounds their logs."""
        with suppress(OSError):
            for log in self._logs.glob("*.log"):
                kept_logs.bound(log)
        restarted = [
            child.supervise(lambda text: ERRORS.print(escape(text), soft_wrap=True))
            for child in self._children
        ]
        if any(restarted):
            try:
                self._write_file()
            except OSError as error:
                ERRORS.print(f"{self._file} is out of date: {error}", markup=False, soft_wrap=True)

    def reload(self) -> None:
        """Replaces the logs; API and coordinator read again the files that they read at their start."""
        with suppress(OSError):
            for log in self._logs.glob("*.log"):
                kept_logs.bound(log, 0)
        for child in (self._coordinator, self._api):
            child.send_signal(signal.SIGHUP)

    def _child(self, name: str, answers: Callable[[], bool], *command: str) -> Child:
        return Child(name, command, self._logs / f"{name}.log", answers)

    def _write_file(self) -> None:
        """Tells other programs where the service is."""
        content = {
            "url": _url(self._settings.port),
            "grpc": f"127.0.0.1:{self._settings.port + 1}",
            "pid": os.getpid(),
            "children": {child.name: child.pid for child in self._children},
        }
        with replacing(self._file) as unfinished:
            unfinished.write_text(json.dumps(content, indent=2) + "\n")


def _redis_command(path: Path) -> list[str]:
    """A redis-server that is a wire between processes: no port, no files, never drops messages."""
    options = {
        "port": "0",
        "unixsocket": str(path),
        "unixsocketperm": "700",
        "save": "",
        "appendonly": "no",
        "maxmemory-policy": "noeviction",
        "dir": str(path.parent),
    }
    return [
        str(need_program("redis-server")),
        *(word for name, value in options.items() for word in (f"--{name}", value)),
    ]


def _make_folder(data: Path) -> None:
    """Tries a piece that a start needs: a full disk is reported before anything is begun."""
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    make_private(data)
    with tempfile.TemporaryFile(dir=data) as probe:
        probe.write(bytes(_PROBE_BYTES))
        probe.flush()
        os.fsync(probe.fileno())


@contextmanager
def _told(data: Path) -> Iterator[None]:
    """What the system refuses, in a sentence."""
    try:
        yield
    except NocturneError as error:
        raise NocturneClientError(str(error)) from error
    except OSError as error:
        raise NocturneClientError(
            f"{data} can't be written ({error.strerror or error}); see to its rights, make room on its disk, "
            "or choose another folder with --data"
        ) from error


@contextmanager
def only_one_service(data: Path) -> Iterator[None]:
    """Holds the folder; the lock goes with the process, however it ends."""
    with (data / LOCK).open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise NocturneClientError(f"a service runs on {data} already{_where(data)}") from error
        yield


def _where(data: Path) -> str:
    try:
        return f": {json.loads((data / 'service.json').read_text())['url']}"
    except (OSError, ValueError, KeyError):
        return ""


def _check_ports(port: int) -> None:
    """Asks before anything is started: a taken port is the most common trouble, and worth a clear word."""
    for number in (port, port + 1):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", number))
            except OSError as error:
                message = (
                    f"port {number} is taken; choose another one with --port (gRPC takes the one above it)"
                )
                raise NocturneClientError(message) from error


def _url(port: int) -> str:
    return f"http://127.0.0.1:{port}"


def _announce(settings: UpSettings, token: str | None) -> None:
    workers = f"worker processes: {settings.workers}, threads of each: {settings.threads}"
    text = (
        f"Page and API   [bold]{_url(settings.port)}[/]\n"
        f"gRPC           127.0.0.1:{settings.port + 1}\n"
        f"Data           {escape(str(settings.data))}\n"
        f"Running        {workers}\n"
        + (f"Token          {token}\n               of an admin; it can't be had again\n" if token else "")
        + "\n"
        "nocturne submit SCENE --watch    Ctrl-C stops everything"
    )
    CONSOLE.print(Panel(text, title="Nocturne", expand=False))
