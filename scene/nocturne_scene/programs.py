"""Finds the programs of this project."""

import os
import shutil
from importlib.util import find_spec
from pathlib import Path

# scene/nocturne_scene/programs.py, two folders down from the checkout
CHECKOUT = Path(__file__).resolve().parents[2]
_BUILT = CHECKOUT / "build" / "release" / "worker"


def find_program(name: str) -> Path | None:
    """The program, from the folder NOCTURNE_BIN, this checkout's build, the package nocturne-worker, or PATH;
    None if in none of them."""
    folders = [os.environ.get("NOCTURNE_BIN", ""), str(_BUILT), _packed(), os.environ.get("PATH", os.defpath)]
    found = shutil.which(name, path=os.pathsep.join(folder for folder in folders if folder))
    return Path(found) if found else None


def _packed() -> str:
    """Where that package keeps them."""
    spec = find_spec("nocturne_worker")
    return str(Path(spec.origin).parent / "bin") if spec and spec.origin else ""
