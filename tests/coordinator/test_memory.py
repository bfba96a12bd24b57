"""The memory that the coordinator may use."""

import os
from pathlib import Path

from nocturne_coordinator.memory import memory_bytes

_MACHINE = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def _bounds(root: Path, own: str, **bounds: str) -> int:
    for name, text in bounds.items():
        place = root / name.replace("__", "/").replace("_max", ".max").replace("_limit", ".limit")
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text)
    (root / "own").write_text(own)
    return memory_bytes(root, root / "own")


def test_the_lowest_bound_of_all_groups_holds(tmp_path: Path) -> None:
    """As files of the kernel have it, by its documents on cgroups of version 2."""
    found = _bounds(tmp_path, "0::/pods/one\n", pods__memory_max="4194304\n", pods__one__memory_max="max\n")
    assert found == 4 * 2**20


def test_version_1_has_a_tree_for_each_kind(tmp_path: Path) -> None:
    own = "9:name=systemd:/\n4:cpu,memory:/farm\n0::/elsewhere\n"
    assert _bounds(tmp_path, own, memory__farm__memory_limit_in_bytes="2097152\n") == 2 * 2**20


def test_without_bounds_it_is_the_machines(tmp_path: Path) -> None:
    assert _bounds(tmp_path, "0::/\n", memory_max="max\n") == _MACHINE
    assert memory_bytes(tmp_path / "none", tmp_path / "none") == _MACHINE
