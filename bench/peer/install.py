"""Mitsuba 3 in a separate environment: a peer to measure against, not a dependency."""

import os
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from bench.report import Skipped

# bench/peer/install.py, two folders down from the checkout
_FOLDER = Path(__file__).resolve().parents[2] / "build" / "peers"
_PYTHON = _FOLDER / "bin" / "python"
_VERSION = "3.9.1"
_PACKAGES = (f"mitsuba=={_VERSION}", "numpy")
_SCALAR = "scalar_spectral"
# Of Debian 12. Its default, 14, can't compile Mitsuba's kernels ("Cannot select: fminimum").
_LLVM_PACKAGE = "libllvm19"
_LLVM_NAMES = ("libLLVM-19.so", "libLLVM.so.19.1")
_LIBRARIES = (Path("/usr/lib/x86_64-linux-gnu"), Path("/usr/lib/llvm-19/lib"), Path("/usr/lib64"))


@dataclass(frozen=True)
class Installed:
    """How to start it."""

    python: Path
    variant: str
    environment: dict[str, str]
    version: str = _VERSION

    def variants(self) -> list["Installed"]:
        """This one, and the scalar one, which is the faster in density grids and with many shapes."""
        scalar = replace(self, variant=_SCALAR)
        return [self] if self.variant == _SCALAR else [self, scalar]


def install() -> Installed:
    """Makes the environment where it is missing; Skipped where that can't be."""
    if _has_mitsuba() is not True:
        print(f"bench: installing Mitsuba {_VERSION} into {_FOLDER}", file=sys.stderr)
        _need([sys.executable, "-m", "venv", "--clear", _FOLDER])
        _need([_PYTHON, "-m", "pip", "install", "--quiet", *_PACKAGES])
    llvm = _find_llvm() or _get_llvm()
    if llvm is None:
        print(
            f"bench: no LLVM 19 (`apt-get install {_LLVM_PACKAGE}`), so Mitsuba's scalar variant is measured",
            file=sys.stderr,
        )
        return Installed(_PYTHON, _SCALAR, dict(os.environ))
    environment = {**os.environ, "DRJIT_LIBLLVM_PATH": str(llvm)}
    return Installed(_PYTHON, "llvm_ad_spectral", environment)


def _has_mitsuba() -> bool:
    if not _PYTHON.exists():
        return False
    says = f"import importlib.metadata as m, numpy; assert m.version('mitsuba') == '{_VERSION}'"
    return subprocess.run([_PYTHON, "-c", says], check=False, capture_output=True).returncode == 0


def _find_llvm() -> Path | None:
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named:
        return Path(named)
    places = [folder / name for folder in _LIBRARIES for name in _LLVM_NAMES]
    return next((place for place in places if place.exists()), None)


def _get_llvm() -> Path | None:
    """Installs it where that needs no question."""
    if os.geteuid() != 0:
        return None
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    command = ["apt-get", "-qq", "-y", "--no-install-recommends", "install", _LLVM_PACKAGE]
    try:
        subprocess.run(command, check=False, capture_output=True, env=quiet)
    except OSError:
        return None
    return _find_llvm()


def _need(command: list[object]) -> None:
    words = [str(word) for word in command]
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = (done.stderr.strip() or done.stdout.strip()).rpartition("\n")[2]
        raise Skipped(f"Mitsuba can't be installed: {' '.join(words[:4])} ...: {last}")


if __name__ == "__main__":
    install()
