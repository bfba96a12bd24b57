"""One file tried in a separate process, within bounds of time and memory."""

import multiprocessing
import resource
import subprocess
import tempfile
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import need_program
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

# A guard; most files take a second.
_SECONDS = 300.0
_MEMORY = 6 * 2**30

# The test render: a small square.
_FILM = 32, 32, 4
DARK = "its image is black"

# Outcomes, best first.
STRICT, LOSSY, REFUSED, FAILED = "strict", "with losses", "refused", "failed"
NO_SCENE = "no scene"


@dataclass(frozen=True)
class Outcome:
    """The outcome of a file."""

    kind: str
    reasons: tuple[str, ...] = ()
    """Losses, or why it was refused."""
    seconds: float = 0.0
    megabytes: int = 0


def tried(file: Path, root: Path, *, renders: bool) -> Outcome:
    """Import a file, and render it if asked; with losses if it has unsupported parts."""
    # A file without losses would have been imported strictly, too.
    # Not a fork of this process: the threads of its image library would be missing in it.
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(theirs, file, root, renders))
    process.start()
    theirs.close()
    try:
        found: Outcome = ours.recv() if ours.poll(_SECONDS) else Outcome(FAILED, ("takes too long",))
    except EOFError:
        found = Outcome(FAILED, ("the process ended",))
    process.kill()
    process.join()
    return found


def _work(sender: Connection, file: Path, root: Path, renders: bool) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    started = time.monotonic()
    kind, reasons = _outcome(file, root, renders)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    sender.send(Outcome(kind, reasons, time.monotonic() - started, memory))


def _outcome(file: Path, root: Path, renders: bool) -> tuple[str, tuple[str, ...]]:
    try:
        with tempfile.TemporaryDirectory() as kept:
            out = Path(kept) / "scene"
            imported = import_scene(file, out, ImportOptions(root, allow_missing=True))
            dark = renders and not _is_lit(imported.document, Path(kept))
    except InputError as error:
        return REFUSED, tuple(each.message for each in error.problems)
    except Exception as error:  # whatever it is, it is counted
        problems = getattr(error, "problems", ())
        shown = tuple(f"rendering: {each.message}" for each in problems)
        return FAILED, shown or (f"{type(error).__name__}: {error}"[:300],)
    losses = tuple(each.message for each in imported.missing)
    return (LOSSY if losses else STRICT), ((*losses, DARK) if dark else losses)


def _is_lit(document: Path, folder: Path) -> bool:
    """Render a document; whether there is any light in the image, all of whose numbers are finite."""
    compiled = compile_to(document, folder / "compiled", *_FILM)
    image = folder / "image.exr"
    command: list[str | Path] = [
        need_program("nocturne-trace"),
        compiled.scene,
        "-o",
        image,
        "--threads",
        "1",
    ]
    command += ["--quiet", "--schedule", compiled.schedule, "--blobs", compiled.blobs]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=_SECONDS)
    if done.returncode:
        raise ChildProcessError(f"nocturne-trace ended with {done.returncode}: {done.stderr[-200:]}")
    values = read_picture(image).xyz
    if not np.all(np.isfinite(values)):
        raise ValueError("its image has numbers that are not finite")
    return bool(np.any(values > 0))
