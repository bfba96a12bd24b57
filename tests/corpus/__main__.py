"""python -m tests.corpus MIRRORS -o PAGE.md: import and render the available files of a corpus; write the
results.

With --means PYTHON, of an environment with Mitsuba, it renders Mitsuba's files by both renderers instead and
writes how far the means of their images are apart.

MIRRORS holds clones of the repositories in sources.toml, with or without a work tree, as `owner/name` or
`owner+name`; those that are not there are left out. Files are read from their newest commit, or
from the one that is named.
"""

import argparse
import re
import subprocess
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from nocturne_scene.formats.import_scene import FORMATS

from tests.corpus import means
from tests.corpus.trying import DARK, FAILED, LOSSY, NO_SCENE, REFUSED, STRICT, Outcome, tried

_SOURCES = Path(__file__).with_name("sources.toml")
_KINDS = (STRICT, LOSSY, REFUSED, FAILED, NO_SCENE)
_SHAPES = re.compile(r"^\s*(Shape|ObjectInstance|Include|Import)\b", re.MULTILINE)
# Characters of a reason that are shown: names and numbers differ after them.
_SHOWN = 90


@dataclass(frozen=True)
class Tried:
    """A file, and its outcome."""

    format: str
    repository: str
    name: str
    outcome: Outcome


def git_folder(mirrors: Path, repository: str) -> Path | None:
    """The git directory of a clone; None if there is none."""
    for name in (repository, repository.replace("/", "+")):
        for inside in (".git", "repo/.git", "repo", ""):
            folder = mirrors / name / inside
            if (folder / "HEAD").is_file():
                return folder
    return None


def chosen(names: list[str], source: dict[str, Any]) -> list[str]:
    """The scenes among the files of a repository."""
    return sorted(
        name
        for name in names
        if any(fnmatch(name, pattern) for pattern in source["files"])
        and name.lower().endswith(tuple(FORMATS))
        and not any(fnmatch(name, pattern) for pattern in source.get("without", ()))
    )


def top_folder(pattern: str) -> str:
    """The folder that holds all files of a pattern, as their names begin; empty: they may be anywhere."""
    folder, slash, _ = pattern.split("*")[0].rpartition("/")
    return folder + slash


@dataclass(frozen=True)
class There:
    """A scene of the corpus, in a folder for as long as it is looked at."""

    format: str
    repository: str
    name: str
    root: Path
    """Holds all that the scene refers to."""

    @property
    def file(self) -> Path:
        """The scene's own file."""
        return self.root / self.name


def attempts(mirrors: Path, only: str, *, renders: bool) -> Iterator[Tried]:
    """Try every file that is there."""
    for each in files(mirrors, only):
        outcome = tried(each.file, each.root, renders=renders) if is_scene(each.file) else Outcome(NO_SCENE)
        yield Tried(each.format, each.repository, each.name, outcome)


def files(mirrors: Path, only: str) -> Iterator[There]:
    """Every file that is there."""
    for source in tomllib.loads(_SOURCES.read_text())["source"]:
        git = git_folder(mirrors, source["repository"])
        if git is None or only not in source["format"]:
            continue
        revision = source.get("revision", "HEAD")
        listed = subprocess.run(
            ["git", f"--git-dir={git}", "ls-tree", "-r", "--format=%(objectname) %(path)", revision],
            check=True,
            capture_output=True,
            text=True,
        )
        objects = {
            name: digest for digest, _, name in (line.partition(" ") for line in listed.stdout.splitlines())
        }
        scenes = chosen(list(objects), source)
        tops = (*map(top_folder, source["files"]), *source.get("beside", ()))
        with tempfile.TemporaryDirectory() as kept:
            _write(git, {name: objects[name] for name in objects if name.startswith(tops)}, Path(kept))
            for name in filter(lambda name: (Path(kept) / name).exists(), scenes):
                yield There(source["format"], source["repository"], name, Path(kept))


def is_scene(file: Path) -> bool:
    """Whether a file, of pbrt's, holds or names anything that has a shape.

    Exporters' tests of cameras, lights and materials have none.
    """
    return (
        file.suffix != ".pbrt"
        or _SHAPES.search(file.read_text(encoding="utf-8", errors="replace")) is not None
    )


def _write(git: Path, objects: dict[str, str], folder: Path) -> None:
    """Write files of a repository; those that the clone does not hold are left out."""
    with subprocess.Popen(
        ["git", f"--git-dir={git}", "cat-file", "--batch"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as reader:
        if reader.stdin is None or reader.stdout is None:
            raise RuntimeError("git has no pipes")
        for name, digest in objects.items():
            reader.stdin.write(f"{digest}\n".encode())
            reader.stdin.flush()
            _, kind, *size = reader.stdout.readline().decode().split()
            if kind == "blob":
                content = reader.stdout.read(int(size[0]))
                reader.stdout.read(1)
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes(content)


def page(found: list[Tried]) -> str:
    """Counts by format and reason, and every file that is not imported strictly.

    Files that are no scenes are not counted.
    """
    lines = ["# Scenes of others", "", f"| format | files | {' | '.join(_KINDS)} | {DARK} |"]
    lines += ["| --- |" + " --- |" * (len(_KINDS) + 2)]
    for name in sorted({each.format for each in found}):
        outcomes = [each.outcome for each in found if each.format == name]
        kinds = Counter(each.kind for each in outcomes)
        dark = sum(DARK in each.reasons for each in outcomes)
        counts = [len(outcomes) - kinds[NO_SCENE], *(kinds[kind] for kind in _KINDS), dark]
        lines.append(f"| {name} | " + " | ".join(map(str, counts)) + " |")
    slowest = max(found, key=lambda each: each.outcome.seconds)
    largest = max(found, key=lambda each: each.outcome.megabytes)
    lines += ["", f"Slowest: {slowest.name}, {slowest.outcome.seconds:.1f} s. "]
    lines[-1] += f"Largest: {largest.name}, {largest.outcome.megabytes:,} MB."
    reasons = Counter(
        (each.format, reason)
        for each in found
        for reason in {reason[:_SHOWN] for reason in each.outcome.reasons}
    )
    lines += ["", "| files | format | reason |", "| --- | --- | --- |"]
    lines += [f"| {count} | {name} | {reason} |" for (name, reason), count in reasons.most_common()]
    lines += ["", "| file | outcome | reasons |", "| --- | --- | --- |"]
    lines += [
        f"| {each.repository}: {each.name} | {each.outcome.kind} | "
        + "; ".join(reason[:_SHOWN] for reason in each.outcome.reasons[:6]).replace("|", "/")
        + " |"
        for each in found
        if each.outcome.kind not in (STRICT, NO_SCENE) or each.outcome.reasons
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tests.corpus")
    parser.add_argument("mirrors", type=Path, help="Folder with clones of the repositories.")
    parser.add_argument("--output", "-o", type=Path, required=True, help="The page to write.")
    parser.add_argument("--format", default="", help="Only formats whose name holds this.")
    parser.add_argument(
        "--import-only", action="store_true", help="Don't render, which takes most of the time."
    )
    parser.add_argument(
        "--means",
        type=Path,
        metavar="PYTHON",
        help="Compare with renders by the Mitsuba of this environment.",
    )
    parser.add_argument("--names", default="*", help="With --means, only files of this pattern.")
    arguments = parser.parse_args()
    if arguments.means:
        scenes = (
            each for each in files(arguments.mirrors, means.FORMAT) if fnmatch(each.name, arguments.names)
        )
        rows = [means.row(each.name, each.file, each.root, arguments.means) for each in scenes]
        arguments.output.write_text(means.page(rows), encoding="utf-8")
        return
    found = list(attempts(arguments.mirrors, arguments.format, renders=not arguments.import_only))
    if not found:
        parser.error(f"{arguments.mirrors} holds none of the repositories in {_SOURCES.name}")
    arguments.output.write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main()
