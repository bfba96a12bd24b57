"""Dependency rules of worker/src: the table in worker/README.md, the CMake files and the includes agree.

All folders are on one include path, so the build alone misses a header of a folder that is not linked.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "worker" / "src"

_ROW = re.compile(r"^\| `(\w+)` \|[^|]+\|([^|]*)\|[^|]*\|$", re.MULTILINE)
_SUBFOLDER = re.compile(r"^add_subdirectory\((\w+)\)", re.MULTILINE)
_INCLUDE = re.compile(r'^#include "(\w+)/', re.MULTILINE)

# Libraries that are not folders of worker/src.
_NO_FOLDERS = {"contracts", "contracts_grpc", "flags"}


def _order() -> list[str]:
    """Folders, each after those that it may use."""
    return _SUBFOLDER.findall((SOURCES / "CMakeLists.txt").read_text(encoding="utf-8"))


def _linked(folder: str) -> set[str]:
    """Folders that one links by its own CMake file."""
    return _nocturne_libraries(folder) - {folder} - _NO_FOLDERS


def _nocturne_libraries(folder: str) -> set[str]:
    text = (SOURCES / folder / "CMakeLists.txt").read_text(encoding="utf-8")
    return set(re.findall(r"\bnocturne_(?!library)(\w+)", text))


def _reachable(folder: str) -> set[str]:
    """The folders that a folder may include: itself, its dependencies, and theirs."""
    found = {folder}
    for linked in _linked(folder):
        found |= _reachable(linked)
    return found


def _table() -> dict[str, set[str]]:
    page = (ROOT / "worker" / "README.md").read_text(encoding="utf-8")
    return {folder: set(re.findall(r"`(\w+)`", uses)) for folder, uses in _ROW.findall(page)}


def test_every_folder_is_built_and_in_the_table() -> None:
    folders = {path.parent.name for path in SOURCES.glob("*/CMakeLists.txt")}
    assert folders == set(_order()) == set(_table())
    assert folders == {path.name for path in SOURCES.iterdir() if path.is_dir()}


def test_the_table_says_what_is_linked() -> None:
    assert _table() == {folder: _linked(folder) for folder in _order()}


def test_folders_link_only_those_above_them() -> None:
    order = _order()
    below = {folder: _linked(folder) - set(order[:index]) for index, folder in enumerate(order)}
    assert {folder: names for folder, names in below.items() if names} == {}


@pytest.mark.parametrize("folder", _order())
def test_includes_come_from_what_is_linked(folder: str) -> None:
    allowed = _reachable(folder)
    wrong = {
        str(path.relative_to(SOURCES)): sorted(foreign)
        for path in (SOURCES / folder).rglob("*")
        if path.suffix in (".h", ".cpp")
        and (foreign := set(_INCLUDE.findall(path.read_text(encoding="utf-8"))) & set(_order()) - allowed)
    }
    assert wrong == {}
