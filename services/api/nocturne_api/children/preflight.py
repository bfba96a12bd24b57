"""Preflights one scene: the job on standard input, the answer on standard output, both JSON."""

import json
import os
import resource
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError, NocturneError, NotFound, Problem
from nocturne_scene.simplify.report import as_json
from nocturne_scene.simplify.search import Request, run_preflight
from nocturne_scene.simplify.simplification import assets_of

# As `nocturne preflight` has it: seconds for most scenes, and enough pixels for their parts.
_PILOT_EDGE = 64


def main() -> None:
    """Reads the request, runs the preflight, writes the report."""
    job = json.load(sys.stdin)
    # Its renders inherit both.
    os.nice(10)
    resource.setrlimit(resource.RLIMIT_AS, (job["memory_bytes"], job["memory_bytes"]))
    try:
        with tempfile.TemporaryDirectory(prefix="nocturne-preflight-") as folder:
            answer = _planned(job, Path(folder))
    except InputError as error:
        answer = {"problems": [[each.place, each.message] for each in error.problems]}
    except NocturneError as error:
        answer = {"failed": str(error)}
    json.dump(answer, sys.stdout)


def _planned(job: dict[str, Any], folder: Path) -> dict[str, Any]:
    store = BlobStore(Path(job["blobs"]), ObjectStore(job["objects"]) if job["objects"] else None)
    _link_assets(job["scene"], store, BlobStore(folder / "blobs").root)
    threads = max(1, len(os.sched_getaffinity(0)) // 2)
    film = job["width"], job["height"]
    request = Request(job["error"], *film, _PILOT_EDGE, job["budget_seconds"], threads)
    found = run_preflight(request, job["scene"], folder, _say_nothing)
    return {**as_json(found), "document": found.document}


def _say_nothing(what: str, steps: int) -> Callable[[], None]:
    del what, steps
    return lambda: None


def _link_assets(document: Any, store: BlobStore, root: Path) -> None:
    """The scene's files, where the pilot looks for them; files that it makes stay out of the data folder."""
    for asset in sorted(assets_of(document)):
        digest = asset.removeprefix("sha256:")
        try:
            file = store.path(digest)
        except (NotFound, InputError) as error:
            raise InputError([Problem("$.scene", str(error))]) from None
        (root / digest[:2]).mkdir(exist_ok=True)
        link = root / digest[:2] / digest
        link.symlink_to(file.resolve())


if __name__ == "__main__":
    main()
