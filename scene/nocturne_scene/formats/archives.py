"""ZIP archives of scenes, unpacked within bounds; and which file of many is the scene."""

import stat
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from nocturne_scene.errors import InputError

END = ".zip"

MAX_FILES = 10_000
MAX_BYTES = 4 * 2**30

_PIECE_BYTES = 2**20

# Bytes of a file in which names of others are looked for, and how many names are shown.
_TEXT_BYTES = 16 * 2**20
_TOLD = 8

_MESH = ".obj"


def unpack(archive: Path, folder: Path) -> list[str]:
    """Write the files of an archive below a folder; return their paths in it. Raises InputError."""
    left = MAX_BYTES
    try:
        with zipfile.ZipFile(archive) as opened:
            members = [each for each in opened.infolist() if not each.filename.endswith("/")]
            if len(members) > MAX_FILES:
                raise InputError.at(archive.name, f"has {len(members)} files; at most {MAX_FILES} are read")
            for member in members:
                check_path(member.filename, archive.name)
                if stat.S_ISLNK(member.external_attr >> 16):
                    raise InputError.at(archive.name, f'"{member.filename}" is a link; expected files')
                left -= _write(opened, member, folder / member.filename, left, archive.name)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, zlib.error) as error:
        raise InputError.at(archive.name, f"can't be unpacked: {error}") from None
    except UnicodeDecodeError:
        raise InputError.at(archive.name, "can't be unpacked: it has names that are no text") from None
    except OSError as error:
        raise InputError.at(archive.name, f"can't be unpacked: {error.strerror}") from None
    return [member.filename for member in members]


def check_path(name: str, place: str) -> None:
    """Raise InputError unless a file's path stays below its folder."""
    path = PurePosixPath(name)
    if not path.parts or path.is_absolute() or ".." in path.parts or "\\" in name or "\0" in name:
        raise InputError.at(place, f'"{name[:100]}" is no path below its folder')


def scene_among(names: Iterable[str], ends: Iterable[str], place: str, folder: Path) -> str:
    """Return the scene: the file nearest to the top that ends in one of `ends`, "scene" first.

    Of several, all in `folder`, it is the one that no other one names. Raises InputError where that leaves
    several, or there is none.
    """
    found = [name for name in names if name.lower().endswith(tuple(ends))]
    if not found:
        raise InputError.at(place, f"holds no scene; expected a file that ends in {', '.join(ends)}")

    # Meshes of other scenes are such files, too.
    found = [name for name in found if not name.lower().endswith(_MESH)] or found

    def order(name: str) -> tuple[int, bool]:
        path = PurePosixPath(name)
        return len(path.parts), not path.name.lower().startswith("scene.")

    first = min(map(order, found))
    likely = sorted(name for name in found if order(name) == first)
    if len(likely) > 1:
        texts = {name: _beginning(folder / name) for name in likely}
        parts = {
            name
            for name in likely
            if any(PurePosixPath(name).name.encode() in text for of, text in texts.items() if of != name)
        }
        likely = [name for name in likely if name not in parts] or likely
    if len(likely) > 1:
        listed = ", ".join(likely[:_TOLD]) + (
            f" and {len(likely) - _TOLD} more" if len(likely) > _TOLD else ""
        )
        raise InputError.at(
            place,
            f"holds several scenes, {listed}; give one of them by itself, or call it "
            f"scene{PurePosixPath(likely[0]).suffix}",
        )
    return likely[0]


def _beginning(file: Path) -> bytes:
    with file.open("rb") as opened:
        return opened.read(_TEXT_BYTES)


def _write(opened: zipfile.ZipFile, member: zipfile.ZipInfo, file: Path, most_bytes: int, place: str) -> int:
    """Write one file; return its bytes. What its header says of its size is not believed."""
    written = 0
    file.parent.mkdir(parents=True, exist_ok=True)
    with opened.open(member) as packed, file.open("xb") as out:
        while piece := packed.read(_PIECE_BYTES):
            written += len(piece)
            if written > most_bytes:
                raise InputError.at(place, f"unpacks to more than {MAX_BYTES} bytes")
            out.write(piece)
    return written
