"""Makes a report by the program `nocturne report`: the job on standard input, why it failed on standard
output, both JSON. The client's package is there wherever a service is, as a program alone.
"""

import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import NocturneError

_DIGEST = "sha256:"


def main() -> None:
    """Reads the job, answers it."""
    job = json.load(sys.stdin)
    # The program inherits both.
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (job["memory_bytes"], job["memory_bytes"]))
    try:
        answer = _report(job)
    except (NocturneError, OSError) as error:
        answer = {"failed": str(error)}
    json.dump(answer, sys.stdout)


def _report(job: dict[str, Any]) -> dict[str, Any]:
    folder = Path(job["folder"])
    store = BlobStore(Path(job["blobs"]), ObjectStore(job["objects"]) if job["objects"] else None)
    scene = folder / "scene.json"
    scene.write_text(json.dumps(_with_files(job["scene"], store, folder)), encoding="utf-8")
    command = [sys.executable, "-m", "nocturne_client", "report", job["image"], "--scene", str(scene)]
    for option in ("require", "task", "title", "annual"):
        command += [f"--{option}", job[option]] if job[option] else []
    for panorama in job["glare"]:
        command += ["--glare", panorama]
    done = subprocess.run(  # noqa: S603 - our own program
        [*command, "-o", job["output"]], cwd=folder, capture_output=True, text=True, check=False
    )
    if done.returncode == 0:
        return {}
    said = " ".join(done.stderr.split()).removeprefix("Error: ")
    return {"failed": said[-1000:] or "the report could not be made"}


def _with_files(scene: Any, store: BlobStore, folder: Path) -> Any:
    """The document with its files beside it."""
    if isinstance(scene, dict):
        asset = scene.get("asset")
        if isinstance(asset, str) and asset.startswith(_DIGEST):
            name = asset.removeprefix(_DIGEST)
            if not (folder / name).exists():
                shutil.copyfile(store.path(name), folder / name)
            scene = {**scene, "asset": name}
        return {key: _with_files(value, store, folder) for key, value in scene.items()}
    if isinstance(scene, list) and scene and isinstance(scene[0], dict | list):
        return [_with_files(each, store, folder) for each in scene]
    return scene


if __name__ == "__main__":
    main()
