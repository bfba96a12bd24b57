"""The process that forks a throw-away child for each scene. `python -m nocturne_api.compiling.server SOCKET`.

It has one thread, and imports and loads what a compile needs once, so that a child costs a fork. Only what
reads mesh files comes later, when nobody has asked for a while: it takes longer to import than all the rest.
The process ends when its standard input does: with the API process, however that ends.
"""

import errno
import importlib
import os
import resource
import selectors
import signal
import socket
import sys
import tempfile
import threading
import time
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path

from nocturne_coordinator.errors import ObjectStoreUnavailable, StoreUnavailable
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_layers, compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError, Problem

from nocturne_api.compiling.pool import WARM_SCENE, CompileLimits

_MEBIBYTE = 1024 * 1024

_IDLE_S = 10.0

_STORAGE = {
    *(errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.EACCES, errno.EPERM, errno.EMFILE),
    *(errno.ENFILE, errno.EFBIG),
}
"""What the data folder's disk and its rights say, and not the scene."""

QUICK_CPU_S, QUICK_WALL_S, _GLANCE_S = 0.3, 3.0, 0.05
"""Processor time, or time that mostly a program may have used, for which a scene goes before others; and how
often that is looked at."""

NICE = 10
"""Added to the nice value of scenes that take longer."""


def main() -> None:
    """Serves until standard input ends."""
    with tempfile.TemporaryDirectory() as folder:
        compile_scene(check_document(WARM_SCENE), BlobStore(Path(folder)))
    # Children are nobody's to wait for: their answer is all that counts.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with socket.socket(socket.AF_UNIX) as listener, selectors.DefaultSelector() as selector:
        listener.bind(sys.argv[1])
        listener.listen(64)
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        selector.register(listener, selectors.EVENT_READ)
        selector.register(sys.stdin, selectors.EVENT_READ)
        idle: float | None = _IDLE_S
        while True:
            ready = [key.fileobj for key, _ in selector.select(idle)]
            if sys.stdin in ready:
                return
            if not ready:
                # With trimesh, which the compiler imports with its first mesh.
                importlib.import_module("nocturne_scene.meshes.files")
                idle = None
                continue
            accepted, _ = listener.accept()
            if os.fork() == 0:
                try:
                    # The compiler may start programs, and wants to know how they end.
                    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                    listener.close()
                    _compile(Connection(accepted.detach()))
                finally:
                    # Without the clean-up that is the server's.
                    os._exit(0)
            accepted.close()


def _compile(caller: "Connection[object, object]") -> None:
    request = caller.recv()
    assert isinstance(request, tuple)  # noqa: S101 - our own parent sent it
    # With the programs that the compiler starts.
    os.setpgid(0, 0)
    threading.Thread(target=_end_with, args=(caller,), daemon=True).start()
    threading.Thread(target=_give_way, daemon=True).start()
    document, root, objects, limits, film, layers = request
    bound(limits)
    try:
        blobs = BlobStore(root, ObjectStore(objects) if objects else None)
        caller.send(
            compile_layers(document, blobs, film, layers) if layers else compile_scene(document, blobs, film)
        )
    except InputError as error:
        caller.send(list(error.problems))
    except ObjectStoreUnavailable as error:
        caller.send(error)
    except OSError as trouble:
        if trouble.errno not in _STORAGE:
            raise
        caller.send(StoreUnavailable(f"the scene can't be written to the data folder: {trouble.strerror}"))
    except MemoryError:
        most = limits.memory_bytes // _MEBIBYTE
        caller.send([Problem("$.scene", f"needs more than {most} MiB to compile")])
    except Exception:
        traceback.print_exc()


def _end_with(caller: "Connection[object, object]") -> None:
    """Whoever asked closes the connection, or dies, when nobody waits for the answer any more."""
    with suppress(EOFError, OSError):
        caller.recv_bytes()
    os.killpg(0, signal.SIGKILL)


def _give_way() -> None:
    """Most scenes take a tenth of a second, for which somebody waits. Those that take longer, or start a
    program, a pilot say, go behind those that have just come, with their programs."""
    begun = time.monotonic()
    while time.process_time() < QUICK_CPU_S and time.monotonic() < begun + QUICK_WALL_S:
        time.sleep(_GLANCE_S)
    os.setpriority(os.PRIO_PGRP, 0, os.getpriority(os.PRIO_PROCESS, 0) + NICE)


def bound(limits: CompileLimits) -> None:
    """More than that ends the process, or is a MemoryError."""
    resource.setrlimit(resource.RLIMIT_AS, (limits.memory_bytes, limits.memory_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (limits.cpu_seconds, limits.cpu_seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # A child that only waits uses no processor.
    signal.alarm(limits.wall_seconds)


if __name__ == "__main__":
    main()
