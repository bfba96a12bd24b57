"""What the pages name is there: files of the repository, and commands with their options."""

import os
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer
from nocturne_client.cli.app import app

from tests.docs.test_docs import PAGES, ROOT

# Dated records of decisions and changes name the files of their day.
_DATED = (ROOT / "docs" / "decisions", ROOT / "CHANGELOG.md")

# The kernel that a how-to page adds.
_INVENTED = {"worker/src/kernels/velvet.h", "tests/worker/kernels/velvet_test.cpp"}

_BUILT = {"build", "dist", "node_modules"}

# Made by `make docs` from the commands themselves.
_GENERATED = ROOT / "docs" / "reference" / "commands.md"

_TOP = "proto|scene|coordinator|services|worker|deploy|examples|tests|bench|docs"
_SOURCE = "py|cpp|h|ts|mjs|proto|toml|sh|acl|yml|yaml"
_PATH = re.compile(rf"`((?:{_TOP})/[\w./-]*[\w/]|(?:[\w.-]+/)*[\w-]+\.(?:{_SOURCE}))`")

_CODE = re.compile(r"^(?:```(?:sh|console)?[^\n]*\n(.*?)^```|((?:^ {4}[^\n]*\n)+))", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"`(nocturne [^`]+)`")
_COMMAND = re.compile(r"(?:^|[(;$&] *)nocturne +([a-z][^\n;|)#&]*)", re.MULTILINE)

CURRENT = [
    page for page in PAGES if page != _GENERATED and not any(page.is_relative_to(dated) for dated in _DATED)
]


@cache
def _files() -> tuple[str, ...]:
    """All files below the folders that pages name, with their folders."""
    found: list[str] = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders if name not in _BUILT and not name.startswith(".")]
        found.extend(f"/{(Path(folder) / name).relative_to(ROOT)}" for name in files)
    return tuple(found)


def _exists(name: str) -> bool:
    """A path from the top, or the end of one."""
    if re.match(rf"(?:{_TOP})/", name) and (ROOT / name).exists():
        return True
    return any(path.endswith(f"/{name}") for path in _files())


@pytest.mark.parametrize("page", CURRENT, ids=lambda page: str(page.relative_to(ROOT)))
def test_files_that_are_named_exist(page: Path) -> None:
    named = set(_PATH.findall(page.read_text(encoding="utf-8"))) - _INVENTED
    assert sorted(name for name in named if not _exists(name.rstrip("/"))) == []


def test_a_file_that_is_not_there_is_found() -> None:
    assert _PATH.findall("`worker/src/kernels/kernel.h` `pose.cpp` `a b.py`") == [
        "worker/src/kernels/kernel.h",
        "pose.cpp",
    ]
    assert _exists("worker/src/kernels/kernel.h")
    assert not _exists("worker/src/kernels/colonel.h")
    assert not _exists("colonel.h")


def _options(words: list[str]) -> set[str] | None:
    """All options of the command that a line starts with; None if there is no such command."""
    command: Any = typer.main.get_command(app)
    for word in words:
        if not hasattr(command, "commands"):
            break
        if word not in command.commands:
            return None
        command = command.commands[word]
    return {option for parameter in command.params for option in parameter.opts} | {"--help"}


def _wrong(line: str) -> str | None:
    """Why a line of a page is no command of ours."""
    words = line.replace("\\\n", " ").split()
    options = _options(words)
    if options is None:
        return f"no such command: {line}"
    asked = {word.partition("=")[0].strip("[]") for word in words if re.match(r"\[?--?[a-z]", word)}
    unknown = asked - options
    return f"no such option: {', '.join(sorted(unknown))} in: {line}" if unknown else None


def _commands(text: str) -> list[str]:
    code = "\n".join(fenced or indented for fenced, indented in _CODE.findall(text))
    lines = [f"nocturne {rest}" for rest in _COMMAND.findall(code.replace("    nocturne", "nocturne"))]
    return [line.removeprefix("nocturne ").strip() for line in [*lines, *_INLINE.findall(text)]]


@pytest.mark.parametrize("page", CURRENT, ids=lambda page: str(page.relative_to(ROOT)))
def test_commands_that_are_shown_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    found = [wrong for line in _commands(text) if line[:1].islower() and (wrong := _wrong(line)) is not None]
    assert found == []


def test_a_command_that_is_not_there_is_found() -> None:
    page = "```sh\nID=$(nocturne submit s.json)\nnocturne sumbit s.json\n```\n`nocturne get ID --tiff F`\n"
    found = [wrong for line in _commands(page) if (wrong := _wrong(line))]
    assert found == ["no such command: sumbit s.json", "no such option: --tiff in: get ID --tiff F"]
