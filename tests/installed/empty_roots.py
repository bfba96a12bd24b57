"""Systems that have Python and nothing else: file systems of Debian in a folder, without a network."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_KEPT = ROOT / "build" / "roots"
_PACKAGES = "python3,python3-venv"
_USER = "1000"
_PIP = ("-m", "pip", "--disable-pip-version-check")


class EmptyRoot:
    """A minimal Debian, in which programs run as a user without rights and with no network but their own."""

    def __init__(self, suite: str) -> None:
        """Is made from Debian's archive where build/roots has none yet. Skips without mmdebstrap or root."""
        if os.geteuid() != 0 or shutil.which("mmdebstrap") is None:
            pytest.skip("needs root, and Debian's mmdebstrap")
        self.folder = _KEPT / suite
        if not (self.folder / "usr" / "bin" / "python3").exists():
            shutil.rmtree(self.folder, ignore_errors=True)
            self.folder.mkdir(parents=True)
            # A mirror may lag behind; its packages are signed all the same.
            late = '--aptopt=Acquire::Check-Valid-Until "false"'
            made = ["mmdebstrap", "--quiet", "--variant=minbase", late, f"--include={_PACKAGES}", suite, "-"]
            with subprocess.Popen(made, stdout=subprocess.PIPE, umask=0o022) as archive:
                subprocess.run(["tar", "-x", "-C", str(self.folder)], check=True, stdin=archive.stdout)
            assert archive.returncode == 0
        self.home = self.folder / "home" / "somebody"
        shutil.rmtree(self.home, ignore_errors=True)
        self.home.mkdir(parents=True)
        os.chown(self.home, int(_USER), int(_USER))

    @property
    def python(self) -> str:
        """Its version, as 3.11."""
        return (self.folder / "usr" / "bin" / "python3").readlink().name.removeprefix("python")

    def run(self, script: str) -> str:
        """What a script of the user's prints; all that it started is ended."""
        inside = ["chroot", f"--userspec={_USER}:{_USER}", str(self.folder)]
        inside += ["env", "-i", "HOME=/home/somebody", "PATH=/usr/bin:/bin", "/bin/sh", "-e", "-c"]
        prepare = f'ip link set lo up; mount -t proc proc {self.folder}/proc; exec "$@"'
        away = [
            "unshare",
            "--net",
            "--mount",
            "--pid",
            "--fork",
            "--kill-child",
            "sh",
            "-e",
            "-c",
            prepare,
            "sh",
        ]
        done = subprocess.run(
            [*away, *inside, f"cd; {script}"], capture_output=True, text=True, timeout=900, check=False
        )
        assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
        return done.stdout


def wheels_for(
    python: str, built: Path, wanted: str = "nocturne[all]", program: str = sys.executable
) -> Path:
    """A folder with our wheels and those of all that they need, for this version of Python.

    `program`: a Python that asks; of those for versions of Python, pip takes their dependencies itself.
    """
    folder = _KEPT / f"wheels-{python}"
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("nocturne*.whl"):
        old.unlink()
    options = ["--quiet", "--only-binary=:all:", "--python-version", python, "--dest", str(folder)]
    subprocess.run([program, *_PIP, "download", *options, "--find-links", str(built), wanted], check=True)
    return folder
