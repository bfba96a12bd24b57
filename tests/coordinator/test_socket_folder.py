"""Folders of sockets have short names."""

import socket
import stat
import tempfile
from pathlib import Path

import pytest
from nocturne_coordinator.socket_folder import socket_folder


@pytest.mark.parametrize("more", [0, 40, 150])
def test_a_socket_fits_into_it(more: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    temporary = tmp_path / ("x" * more)
    temporary.mkdir(exist_ok=True)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    with socket_folder() as folder, socket.socket(socket.AF_UNIX) as listener:
        listener.bind(f"{folder}/coordinator.sock")
        assert stat.S_IMODE(Path(folder).stat().st_mode) == 0o700
    assert not Path(folder).exists()
