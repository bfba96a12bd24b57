"""A data folder is its owner's alone, whatever the umask; one that was moved away is not written to."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.data_folder import DataFolder, make_folders
from nocturne_coordinator.store.database import FolderGone

_OPEN = """
import os, sys
from pathlib import Path
os.umask(0)
from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ownership import Ownership
try:
    folder = DataFolder(Path(sys.argv[1]))
except UnusableFolder as error:
    sys.exit(str(error))
folder.webhooks.create("", "https://example.org/")
folder.blobs.put(b"scene")
Ownership(folder.root, folder.database)
for each in folder.root.rglob("*"):
    print(oct(each.stat().st_mode & 0o777), each.relative_to(folder.root))
"""


def opened(path: Path, user: int | None = None) -> subprocess.CompletedProcess[str]:
    """What another process finds in the folder while it has it open."""
    return subprocess.run(
        [sys.executable, "-c", _OPEN, str(path)], capture_output=True, text=True, check=False, user=user
    )


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


def test_a_new_folder_is_for_its_owner_alone(tmp_path: Path) -> None:
    found = opened(tmp_path / "data")
    assert found.returncode == 0, found.stderr
    assert mode(tmp_path / "data") == 0o700
    rights = {name: mode for mode, name in (line.split(" ", 1) for line in found.stdout.splitlines())}
    assert {"nocturne.db", "nocturne.db-wal", "nocturne.db-shm", "coordinator.lock"} <= rights.keys()
    assert all(int(mode, 8) & 0o077 == 0 for mode in rights.values()), rights


def test_one_that_others_could_read_is_closed(tmp_path: Path) -> None:
    data = tmp_path / "data"
    opened(data)
    data.chmod(0o755)
    (data / "nocturne.db").chmod(0o644)
    found = opened(data)
    assert f"{data} could be read by others (mode drwxr-xr-x); now it is closed" in found.stderr
    assert (mode(data), mode(data / "nocturne.db")) == (0o700, 0o600)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can run as somebody else")
def test_anothers_folder_is_refused(tmp_path: Path) -> None:
    data = tmp_path / "data"
    for each in (data, *list(tmp_path.parents)[:2], tmp_path):
        each.mkdir(exist_ok=True)
        each.chmod(0o777)
    os.chown(data, 1, 1)
    found = opened(data, user=65534)
    assert found.returncode == 1
    assert f"{data} belongs to daemon, and this process runs as nobody" in found.stderr
    assert f"chown -R nobody {data}" in found.stderr
    assert list(data.iterdir()) == []


def test_a_file_system_without_rights_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "data").mkdir(mode=0o755)
    (tmp_path / "data").chmod(0o755)
    # As on a disk of Windows, where it changes nothing.
    monkeypatch.setattr(Path, "chmod", lambda *_, **__: None)
    with pytest.raises(UnusableFolder, match="its file system lets others in"):
        DataFolder(tmp_path / "data")


def test_a_folder_that_was_moved_away_is_not_written_to(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path / "data")
    (tmp_path / "data").rename(tmp_path / "elsewhere")
    with pytest.raises(FolderGone, match="was moved away or replaced"):
        folder.webhooks.create("", "https://example.org/")
    with pytest.raises(FileNotFoundError):
        folder.blobs.put(b"scene")
    with pytest.raises(FileNotFoundError):
        make_folders(tmp_path / "data" / "images" / "r-1" / "image.exr")
    assert not (tmp_path / "data").exists()
    DataFolder(tmp_path / "data").close()
    with pytest.raises(FolderGone):
        folder.check_place()
    (tmp_path / "data").rename(tmp_path / "new")
    (tmp_path / "elsewhere").rename(tmp_path / "data")
    folder.webhooks.create("", "https://example.org/")
    folder.close()
