"""References: long images by the most reliable method, with their own error, stored small.

A reference is the mean of independent images, and its error follows from their differences. A second method,
as independent as the scene allows, makes another one; both must agree.
"""

import hashlib
import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.errors import NocturneClientError

from bench.peer.agreement import Reference, agreement
from bench.peer.contenders import Ours
from bench.report import Figures, results_folder
from bench.scenes import Document, compile_film
from bench.suite.scenes import SuiteScene

THREADS = 2
ROUNDING = 2e-5
"""Relative deviation of a pixel, beyond chance, that single precision and tables may cause."""

_NOT_SHOWN = ("tracing", "important_directions", "name", "source", "note")
_PARTS = 16
_SEED, _CHECK_SEED, _TRIAL_SEED = 1_000_000, 2_000_000, 3_000_000


@dataclass(frozen=True)
class Stored:
    """A reference that was read, and its agreement with a second method."""

    reference: Reference
    agreement: Figures
    cpu_s: float


def make(name: str, scene: SuiteScene, folder: Path, cpu_s: float) -> None:
    """Traces the reference for so long, and a quarter of that by the second method; replaces the stored
    one."""
    document = scene.document(folder)
    reference = _long(scene, document, scene.reference, folder / "reference", cpu_s, _SEED, ())
    baseline = () if scene.check is not None else ("--method", "path")
    check = _long(scene, document, scene.check or {}, folder / "check", cpu_s / 4, _CHECK_SEED, baseline)
    found = agreement(reference, check)
    print(f"bench: reference of {name}: {found}", file=sys.stderr)
    path = _path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    told = json.dumps({"document": digest(document), "agreement": found, "cpu_s": cpu_s})
    np.savez_compressed(
        path,
        y=reference.y.astype(np.float32),
        error=reference.error.astype(np.float32),
        told=np.frombuffer(told.encode(), dtype=np.uint8),
    )


def load(name: str, document: Document | None = None) -> Stored:
    """The stored reference; NocturneClientError where it is missing, or not of the document, if given."""
    path = _path(name)
    remake = f"make it with `python -m bench.suite --references {name!r}`"
    if not path.is_file():
        raise NocturneClientError(f"there is no reference of {name}: {remake}")
    with np.load(path) as data:
        told: dict[str, Any] = json.loads(data["told"].tobytes())
        y, error = (data[key].astype(np.float64) for key in ("y", "error"))
    if document is not None and told["document"] != digest(document):
        raise NocturneClientError(f"the reference of {name} is of another scene: {remake}")
    return Stored(Reference(y, error), told["agreement"], told["cpu_s"])


def digest(document: Document) -> str:
    """The digest of the visible scene; the method of tracing and the notes make no difference."""
    shown = {key: value for key, value in document.items() if key not in _NOT_SHOWN}
    return hashlib.sha256(json.dumps(shown, sort_keys=True).encode()).hexdigest()


def _path(name: str) -> Path:
    return results_folder() / "references" / f"{name.replace(' ', '_')}.npz"


def _long(
    scene: SuiteScene,
    document: Document,
    tracing: dict[str, Any],
    folder: Path,
    cpu_s: float,
    seed: int,
    baseline: tuple[str, ...],
) -> Reference:
    changed = {**document, "tracing": {**document.get("tracing", {}), **tracing}}
    compiled = compile_film(changed, folder.parent, scene.film.width, scene.film.height, 1, folder)
    ours = Ours(compiled, scene.film, THREADS, baseline)
    # Where Sobol points are at their best.
    samples = 2 ** round(math.log2(samples_for(ours, cpu_s / _PARTS)))
    found = Reference.of([ours.frame(samples, seed + part).y for part in range(_PARTS)])
    return Reference(found.y, np.hypot(found.error, ROUNDING * found.y))


def samples_for(ours: Ours, cpu_s: float) -> int:
    """How many samples take so long."""
    samples = 4
    while True:
        frame = ours.frame(samples, _TRIAL_SEED)
        if frame.cpu_s >= 0.1 * cpu_s or samples >= 2**20:
            return max(1, round(samples * cpu_s / max(frame.cpu_s, 1e-3)))
        samples *= 4
