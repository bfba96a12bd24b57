"""One file tried in a process of its own, within bounds of time and memory."""

import multiprocessing
import resource
import tempfile
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from nocturne_client.local.compiled import compile_to
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

_SECONDS = 120.0
_MEMORY = 6 * 2**30

# Outcomes, best first.
STRICT, LOSSY, REFUSED, FAILED = "strict", "with losses", "refused", "failed"


@dataclass(frozen=True)
class Outcome:
    """What came of a file."""

    kind: str
    reasons: tuple[str, ...] = ()
    """Losses, or why it was refused."""
    seconds: float = 0.0
    megabytes: int = 0


def tried(file: Path, root: Path, *, compiles: bool) -> Outcome:
    """Import a file, and compile it if asked; with losses where it has parts without an equal."""
    # What has no losses would have been imported strictly, too.
    # Not a fork of this process: the threads of its image library would be missing in it.
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(theirs, file, root, compiles))
    process.start()
    theirs.close()
    try:
        found: Outcome = ours.recv() if ours.poll(_SECONDS) else Outcome(FAILED, ("takes too long",))
    except EOFError:
        found = Outcome(FAILED, ("the process ended",))
    process.kill()
    process.join()
    return found


def _work(sender: Connection, file: Path, root: Path, compiles: bool) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    started = time.monotonic()
    kind, reasons = _outcome(file, root, compiles)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    sender.send(Outcome(kind, reasons, time.monotonic() - started, memory))


def _outcome(file: Path, root: Path, compiles: bool) -> tuple[str, tuple[str, ...]]:
    try:
        with tempfile.TemporaryDirectory() as kept:
            out = Path(kept) / "scene"
            imported = import_scene(file, out, ImportOptions(root, allow_missing=True))
            if compiles:
                compile_to(imported.document, Path(kept) / "compiled", 64, 64, 1)
    except InputError as error:
        return REFUSED, tuple(each.message for each in error.problems)
    except Exception as error:  # whatever it is, it is counted
        problems = getattr(error, "problems", ())
        shown = tuple(f"compiling: {each.message}" for each in problems)
        return FAILED, shown or (f"{type(error).__name__}: {error}"[:300],)
    losses = tuple(each.message for each in imported.missing)
    return (LOSSY if losses else STRICT), losses
