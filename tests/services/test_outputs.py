"""Output files of commands: refused early if they can't be written; devices and links stay as they are."""

import os
import stat
import threading
from pathlib import Path

import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.outputs import check_output, is_standard_output, written


def write(path: Path, content: bytes) -> None:
    check_output(path)
    with written(path) as file:
        file.write(content)


def device(path: Path) -> Path:
    """A copy of /dev/null, never the real one."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        path.open("wb").close()
    except OSError:
        pytest.skip("no device can be made here")
    return path


def test_a_file_is_whole_or_untouched(tmp_path: Path) -> None:
    path = tmp_path / "image.exr"
    write(path, b"before")
    with pytest.raises(TypeError), written(path) as file:
        file.writelines([b"half", None])  # type: ignore[list-item]
    assert path.read_bytes() == b"before"
    assert stat.S_IMODE(path.stat().st_mode) == 0o644
    path.chmod(0o600)
    write(path, b"after")
    assert path.read_bytes() == b"after"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert list(tmp_path.iterdir()) == [path]


# https://github.com/jliljebl/flowblade/issues/832, https://github.com/LuxCoreRender/LuxCore/issues/46: it was
# noticed at the end of a render.
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("no/such/image.exr", "no such folder"),
        ("file/image.exr", "Not a directory"),
        ("folder", "is a folder"),
        ("link", "is a folder"),
        ("/proc/image.exr", "can't be written"),
    ],
)
def test_what_can_not_be_written_is_told_before(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "file").write_bytes(b"")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("folder")
    with pytest.raises(NocturneClientError, match=said):
        check_output(tmp_path / name)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["file", "folder", "link"]


# https://github.com/sahib/rmlint/issues/763, https://github.com/ocrmypdf/OCRmyPDF/issues/1068,
# https://github.com/bazelbuild/bazel/issues/31038: run as root, a program put a file in place of /dev/null.
def test_a_device_stays_one(tmp_path: Path) -> None:
    path = device(tmp_path / "null")
    write(path, b"image")
    assert stat.S_ISCHR(path.stat().st_mode)
    link = tmp_path / "link"
    link.symlink_to("null")
    write(link, b"image")
    assert link.is_symlink()
    assert stat.S_ISCHR(path.stat().st_mode)


@pytest.mark.parametrize("is_there", [False, True])
def test_a_link_stays_one(tmp_path: Path, is_there: bool) -> None:
    target, link = tmp_path / "target", tmp_path / "link.exr"
    if is_there:
        target.write_bytes(b"before")
    link.symlink_to("target")
    write(link, b"after")
    assert link.is_symlink()
    assert target.read_bytes() == b"after"


def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    found: list[bytes] = []
    reader = threading.Thread(target=lambda: found.append(pipe.read_bytes()))
    reader.start()
    write(pipe, b"image")
    reader.join(10)
    assert found == [b"image"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_standard_output_is_known(tmp_path: Path) -> None:
    assert is_standard_output(Path("/proc/self/fd/1"))
    assert not is_standard_output(tmp_path / "image.exr")
