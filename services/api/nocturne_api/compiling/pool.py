"""Compiles scenes in throw-away child processes: one that takes too much, or crashes, takes nothing else with
it."""

import atexit
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing.connection import Client
from pathlib import Path
from typing import Any

from nocturne_coordinator.errors import ObjectStoreUnavailable, StoreUnavailable
from nocturne_coordinator.socket_folder import socket_folder
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.output import CompiledOutput
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film

WARM_SCENE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.5},
            "luminaire": {"radiance": {"blackbody": 3000}},
        }
    ],
}
"""Compiled once before the first child is made: what that loads, the children need not."""

_GIBIBYTE = 1024**3
_LOOK_S = 0.5
"""How often who waits for a child looks whether it still should."""


class Abandoned(Exception):
    """Nobody waits for the answer any more."""


@dataclass(frozen=True)
class CompileLimits:
    """What one scene may take: bytes of address space, and seconds of processor time."""

    memory_bytes: int = 16 * _GIBIBYTE
    """A mesh of 200 million triangles is 6 GB in files; it is held about twice while it is packed."""
    cpu_seconds: int = 600

    @property
    def wall_seconds(self) -> int:
        """Seconds after which a child is ended that mostly waits."""
        return 2 * self.cpu_seconds + 60


def compile_in_child(
    document: SceneDocument,
    blobs: BlobStore,
    limits: CompileLimits,
    film: Film | None = None,
    abandoned: threading.Event | None = None,
) -> CompiledOutput:
    """Compiles into `blobs`. Takes as long as it takes. `film`: see `compile_scene`.

    Raises InputError where the scene is wrong, or needs more than it may take; ObjectStoreUnavailable, and
    StoreUnavailable where `blobs` can't be written; and Abandoned when `abandoned` is set before it is
    compiled: the child is ended.
    """
    output = _ask_child((document, *_place_of(blobs), limits, film, ()), limits, abandoned)
    assert isinstance(output, CompiledOutput)  # noqa: S101 - what a child without layers sends
    return output


def layers_in_child(
    document: SceneDocument,
    blobs: BlobStore,
    limits: CompileLimits,
    film: Film,
    layers: Sequence[str],
    abandoned: threading.Event,
) -> str:
    """Makes layers as `compile_layers` does. Raises as `compile_in_child`, and Abandoned when `abandoned` is
    set before they are there."""
    return str(_ask_child((document, *_place_of(blobs), limits, film, layers), limits, abandoned))


def _place_of(blobs: BlobStore) -> tuple[Path, str]:
    return blobs.root, "" if blobs.remote is None else blobs.remote.url


def _ask_child(request: object, limits: CompileLimits, abandoned: threading.Event | None = None) -> object:
    with Client(_server_address(), "AF_UNIX") as child:
        child.send(request)
        try:
            while not child.poll(_LOOK_S):
                if abandoned is not None and abandoned.is_set():
                    raise Abandoned
            answer = child.recv()
        except (EOFError, ConnectionResetError):
            raise InputError.at(
                "$.scene",
                f"takes more than {limits.cpu_seconds} s of processor time to compile, or more memory than "
                "there is; the service's log has what the compiler said, if anything",
            ) from None
    if isinstance(answer, ObjectStoreUnavailable | StoreUnavailable):
        raise answer
    if isinstance(answer, list):
        raise InputError(answer)
    return answer


def prepare() -> None:
    """Starts what makes the children, so that the first scene need not wait for it. Returns at once."""
    threading.Thread(target=_server_address, name="compile-server", daemon=True).start()


class _Server:
    """The process that makes the children, and the private folder that its socket is in."""

    def __init__(self) -> None:
        self._folder = socket_folder()
        self.address = f"{self._folder.name}/compile.sock"
        self._process = subprocess.Popen(  # noqa: S603 - ourselves
            [sys.executable, "-m", "nocturne_api.compiling.server", self.address],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert self._process.stdout is not None  # noqa: S101 - asked for above
        with self._process.stdout as said:
            said.readline()

    def is_alive(self) -> bool:
        return self._process.poll() is None

    def close(self) -> None:
        assert self._process.stdin is not None  # noqa: S101 - asked for above
        self._process.stdin.close()
        self._process.wait(10)
        self._folder.cleanup()


_lock = threading.Lock()
_servers: list[_Server] = []


def _server_address() -> str:
    """Where children are made; starts the process that makes them, where it does not run."""
    with _lock:
        if _servers and not _servers[0].is_alive():
            _servers.pop().close()
        if not _servers:
            _servers.append(_Server())
            atexit.register(stop)
        return _servers[0].address


def stop() -> None:
    """Ends the children's parent process; the next scene starts it again, with the environment of then."""
    with _lock:
        while _servers:
            _servers.pop().close()
