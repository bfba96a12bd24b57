"""`nocturne up`: the whole service as children of one process, on one data folder."""

import fcntl
import http.client
import json
import os
import signal
import socket
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from nocturne_scene.replacing import replacing
from rich.markup import escape
from rich.panel import Panel

from nocturne_client.cli.output import CONSOLE, ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.children import Child
from nocturne_client.local.programs import need_program
from nocturne_client.local.tokens import first_token

# Twenty times what it takes on an idle machine.
_START_S = 120.0
# A worker finishes or hands back its job; the others have nothing that takes long.
_GRACE_S = 5.0
_TEND_S = 0.2


@dataclass(frozen=True)
class UpSettings:
    """Data folder, port of page and REST (gRPC is one above), worker processes, threads of each."""

    data: Path
    port: int
    workers: int
    threads: int
    auth: bool = False
    """Callers need a token."""


def run_up(settings: UpSettings) -> None:
    """Runs until SIGINT or SIGTERM, then stops all in order. NocturneClientError if it can't start."""
    stop = threading.Event()

    def ask_to_stop(_: int, __: FrameType | None) -> None:
        stop.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, ask_to_stop)
    _make_folder(settings.data)
    with (
        only_one_service(settings.data),
        tempfile.TemporaryDirectory(prefix="nocturne-", ignore_cleanup_errors=True) as sockets,
    ):
        need_program("nocturne-worker")
        _check_ports(settings.port)
        token = first_token(settings.data) if settings.auth else None
        with _Stack(settings, Path(sockets)) as stack:
            stack.start(stop)
            if not stop.is_set():
                _announce(settings, token)
            while not stop.wait(_TEND_S):
                stack.supervise()
            ERRORS.print("stopping ...")


class _Stack:
    """All children. The sockets between them lie in a folder of mode 0700, so nobody else can connect."""

    def __init__(self, settings: UpSettings, sockets: Path) -> None:
        self._settings = settings
        self._file = settings.data / "service.json"
        self._redis_socket = sockets / "redis.sock"
        self._logs = settings.data / "logs"
        self._logs.mkdir(exist_ok=True)
        for log in self._logs.glob("*.log"):
            log.unlink()
        redis_url = f"unix://{self._redis_socket}"
        grpc_socket = sockets / "grpc.sock"
        self._redis = self._child("redis", *_redis_command(self._redis_socket))
        python = (sys.executable, "-m")
        data = ("--data", str(settings.data))
        self._coordinator = self._child(
            "coordinator", *python, "nocturne_coordinator.main", *data, "--redis", redis_url
        )
        ports = ("--port", str(settings.port), "--grpc-port", str(settings.port + 1))
        self._api = self._child(
            *("api", *python, "nocturne_api.main", *data, *ports, "--grpc-unix", str(grpc_socket)),
            *(["--auth"] if settings.auth else []),
        )
        self._workers = [
            self._child(
                f"worker-{number}",
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
        """Starts all in order, each when what it needs answers; ends early when `stop` is set."""
        self._redis.start()
        self._redis.wait_until(lambda: stop.is_set() or _answers_ping(self._redis_socket), _START_S)
        self._coordinator.start()
        self._api.start()
        self._api.wait_until(lambda: stop.is_set() or _is_ready(self._settings.port), _START_S)
        if not self._coordinator.is_alive():
            raise NocturneClientError(f"coordinator did not start. {self._coordinator.tail()}")
        for worker in self._workers:
            worker.start()
        self._write_file()

    def supervise(self) -> None:
        """Starts again what has died."""
        restarted = [
            child.supervise(lambda text: ERRORS.print(escape(text), soft_wrap=True))
            for child in self._children
        ]
        if any(restarted):
            self._write_file()

    def _child(self, name: str, *command: str) -> Child:
        return Child(name, command, self._logs / f"{name}.log")

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
    try:
        data.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise NocturneClientError(f"can't make the data folder {data}: {error.strerror}") from error


@contextmanager
def only_one_service(data: Path) -> Iterator[None]:
    """Holds the folder; the lock goes with the process, however it ends."""
    with (data / "service.lock").open("w") as lock:
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


def _answers_ping(path: Path) -> bool:
    try:
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(1.0)
            connection.connect(str(path))
            connection.sendall(b"PING\r\n")
            return connection.recv(16).startswith(b"+PONG")
    except OSError:
        return False


def _is_ready(port: int) -> bool:
    # Asked fifty times a second while the API starts; a client of httpx costs 60 ms of processor to make.
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=2.0)
    try:
        connection.request("GET", "/readyz")
        return connection.getresponse().status == 200
    except (OSError, http.client.HTTPException):
        return False
    finally:
        connection.close()


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
