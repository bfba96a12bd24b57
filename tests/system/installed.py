"""Virtual environments with our wheels and nothing of this checkout.

The wheels are built and installed as pip does it. Dependencies are not fetched: each declared
dependency, and its own in turn, is linked from the environment that the tests run in, and
nothing else is there. So a dependency that is used and not declared is missing, as it would be elsewhere, and
no registry is asked.
"""

import os
import subprocess
import sys
from collections.abc import Iterable
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
FOLDERS = {"scene": "scene", "client": "services/client", "service": "services/api"}


def build_wheels(folder: Path) -> dict[str, Path]:
    """The three wheels of this checkout, by name."""
    sources = [str(ROOT / each) for each in FOLDERS.values()]
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", str(folder)]
    subprocess.run([*pip, "wheel", *options, *sources], check=True, cwd=folder)
    found = {"client": "nocturne", "scene": "nocturne_scene", "service": "nocturne_service"}
    return {name: next(folder.glob(f"{wheel}-*.whl")) for name, wheel in found.items()}


class Installed:
    """A fresh environment with some of the wheels."""

    def __init__(self, folder: Path, wheels: Iterable[Path], python: str = sys.executable) -> None:
        self.folder = folder
        subprocess.run([python, "-m", "venv", "--without-pip", str(folder)], check=True)
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", str(folder)]
        options = ["--quiet", "--no-deps", "--no-index"]
        subprocess.run([*pip, "install", *options, *map(str, wheels)], check=True)
        self._link_dependencies()

    @property
    def nocturne(self) -> Path:
        """The command line."""
        return self.folder / "bin" / "nocturne"

    @property
    def environment(self) -> dict[str, str]:
        """For programs: nothing of the environment that the tests run in."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        return {**kept, "PATH": f"{self.folder / 'bin'}:{os.defpath}"}

    def run(self, *words: str | Path, **environment: str) -> subprocess.CompletedProcess[str]:
        """The command line with these words."""
        return subprocess.run(
            [self.nocturne, *words],
            env=self.environment | environment,
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    def python(self, code: str) -> str:
        """What a program prints."""
        program = str(self.folder / "bin" / "python")
        done = subprocess.run(
            [program, "-c", code],
            env=self.environment,
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    def _link_dependencies(self) -> None:
        (site,) = self.folder.glob("lib/python3.*/site-packages")
        ours = [Distribution.at(path) for path in site.glob("nocturne*.dist-info")]
        for found in _closure([each for one in ours for each in _applicable(one, "")]):
            for name in {file.parts[0] for file in found.files or () if file.parts[0] != ".."}:
                if not (site / name).exists():
                    (site / name).symlink_to(Path(str(found.locate_file(name))))


def _closure(wanted: list[Requirement]) -> list[Distribution]:
    """Distributions of the test's environment that these requirements lead to."""
    found: dict[tuple[str, str], Distribution] = {}
    while wanted:
        requirement = wanted.pop()
        for extra in ("", *requirement.extras):
            key = (requirement.name.lower(), extra)
            if key in found or requirement.name.startswith("nocturne"):
                continue
            found[key] = distribution(requirement.name)
            wanted += _applicable(found[key], extra)
    return list(found.values())


def _applicable(one: Distribution, extra: str) -> list[Requirement]:
    """What a distribution requires here, with one of its extras or, with an empty name, without."""
    required = [Requirement(each) for each in one.requires or ()]
    return [each for each in required if each.marker is None or each.marker.evaluate({"extra": extra})]
