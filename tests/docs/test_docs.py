"""The pages agree with the repository: links lead somewhere, and all required names are there."""

import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).parents[2]

# Built, or not ours.
_NOT_OURS = {"build", "data", "dist", "node_modules"}

_FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ +(.+)$", re.MULTILINE)
_ELSEWHERE = re.compile(r"[a-z]+:")
_MACHINE_PATH = re.compile(r"(?<![\w.~$}])/(?:work|root|home|Users|mnt)/[\w.]+")


def _pages() -> Iterator[Path]:
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders if name not in _NOT_OURS and not name.startswith(".")]
        yield from (Path(folder) / name for name in files if name.endswith(".md"))


PAGES = sorted(_pages())


@cache
def _anchors(page: Path) -> frozenset[str]:
    """The names of a page's headings, as GitHub makes them."""
    headings = _HEADING.findall(_FENCE.sub("", page.read_text(encoding="utf-8")))
    return frozenset(re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-") for text in headings)


def _broken(page: Path, target: str) -> str | None:
    """Why a link of a page leads nowhere; None if it leads somewhere."""
    path, _, anchor = unquote(target).partition("#")
    found = (page.parent / path).resolve() if path else page
    if not found.is_relative_to(ROOT):
        return "leaves the repository"
    if not found.exists():
        return "there is no such file"
    if anchor and found.suffix == ".md" and anchor not in _anchors(found):
        return "there is no such heading"
    return None


def test_pages_are_found() -> None:
    assert {ROOT / "README.md", ROOT / "docs" / "architecture.md"} <= set(PAGES)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    targets = _LINK.findall(_FENCE.sub("", page.read_text(encoding="utf-8")))
    broken = {
        target: reason
        for target in targets
        if not _ELSEWHERE.match(target) and (reason := _broken(page, target)) is not None
    }
    assert broken == {}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_path_of_somebodys_machine(page: Path) -> None:
    assert _MACHINE_PATH.findall(page.read_text(encoding="utf-8")) == []


def _page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def _without_code_name(page: str, names: list[str]) -> list[str]:
    """The names that the page does not have as `name`."""
    assert names
    return [name for name in names if f"`{name}`" not in page]


# The development environment, and the packages that ship.
_PROJECTS = (
    "pyproject.toml",
    "scene/pyproject.toml",
    "services/client/pyproject.toml",
    "services/api/pyproject.toml",
)


def _project(file: str) -> dict[str, Any]:
    read: dict[str, Any] = tomllib.loads((ROOT / file).read_text(encoding="utf-8"))["project"]
    return read


def test_every_dependency_of_python_has_its_reason() -> None:
    projects = [_project(file) for file in _PROJECTS]
    required = [
        *(name for project in projects for name in project.get("dependencies", ())),
        *(name for project in projects for name in project.get("optional-dependencies", {}).get("all", ())),
        *projects[0]["optional-dependencies"]["dev"],
    ]
    names = [re.split(r"[\[<>=!~; ]", requirement)[0] for requirement in required]
    names = [name for name in names if not name.startswith("nocturne")]
    assert _without_code_name(_page("reference/dependencies.md"), names) == []


def test_every_dependency_of_the_page_has_its_reason() -> None:
    package = json.loads((ROOT / "services" / "web" / "package.json").read_text(encoding="utf-8"))
    names = [*package["dependencies"], *package["devDependencies"]]
    assert _without_code_name(_page("reference/dependencies.md"), names) == []


def test_every_debian_package_has_its_reason() -> None:
    lines = (ROOT / "deploy" / "debian-packages.txt").read_text(encoding="utf-8").splitlines()
    names = [line.split()[0] for line in lines if line.strip() and not line.startswith("#")]
    assert _without_code_name(_page("reference/dependencies.md"), names) == []


def test_dependencies_that_are_gone_have_no_row() -> None:
    rows = re.findall(r"^\| (`.+?) \|", _page("reference/dependencies.md"), re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`([^`]+)`", row)}
    sources = (*_PROJECTS, "services/web/package.json", "deploy/debian-packages.txt")
    wanted = "\n".join((ROOT / source).read_text(encoding="utf-8") for source in sources)
    gone = [name for name in named if not re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", wanted)]
    assert gone == []


def test_decisions_are_numbered_and_dated() -> None:
    numbers = []
    for decision in sorted((ROOT / "docs" / "decisions").glob("[0-9]*.md")):
        title, _, date = decision.read_text(encoding="utf-8").split("\n")[:3]
        number = decision.name[:4]
        assert title.startswith(f"# {number}: "), decision.name
        assert re.match(r"\d{4}-\d\d-\d\d\b", date), decision.name
        numbers.append(number)
    assert len(numbers) == len(set(numbers)) > 0


def test_the_commands_page_is_current() -> None:
    """Make it again with `make docs`."""
    command = [sys.executable, "-m", "typer", "nocturne_client.cli.app", "utils", "docs"]
    named = [*command, "--name", "nocturne", "--title", "All commands and options"]
    made = subprocess.run(named, capture_output=True, text=True, check=True).stdout
    assert made == _page("reference/commands.md")


def test_contributing_says_where_twelve_changes_go() -> None:
    """That the files exist is checked by test_names.py."""
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = page.partition("## Twelve changes")[2]
    rows = re.findall(r"^\| \*\*an? ([^*]+)\*\* \| ([^|]+) \| ([^|]+) \|$", table, re.MULTILINE)
    assert [name for name, _, _ in rows] == [
        *("BSDF", "light", "sensor", "Mitsuba plugin", "API field", "stop condition"),
        *("fault row", "chart", "command", "response curve", "metric", "Redis key"),
    ]
    assert all("`" in change and "`" in tests for _, change, tests in rows)
