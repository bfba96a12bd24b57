"""Files that a scene names: found only inside one folder, and never larger than expected."""

import io
import os
from collections.abc import Sequence
from pathlib import Path

from nocturne_scene.document import bounds
from nocturne_scene.errors import InputError
from nocturne_scene.texts import text_of

# Bytes of a file that is read as text. Geometry and pictures have other bounds.
TEXT_BYTES = 64 * 2**20


class SceneFiles:
    """Resolves names within `root`, links included."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def find(self, name: str, folders: Sequence[Path], place: str) -> Path:
        """Return the first of folder / name that is a file, or that is one but for capitals, as on Windows.

        Raises InputError: `name` is absolute, leads out of the root, or is nowhere.
        """
        if not name or len(name) > bounds.PATH_LENGTH or any(ord(letter) < 32 for letter in name):
            raise InputError.at(place, "expected the name of a file")
        name = name.replace("\\", "/")
        if Path(name).is_absolute() or ":" in name.split("/")[0]:
            raise InputError.at(place, f'"{name[:200]}" is an absolute path; expected one below {self.root}')
        outside = False
        for folder in folders:
            found = (folder / name).resolve()
            if not found.is_relative_to(self.root):
                outside = True
            elif found.is_file():
                return found
        for folder in folders:
            for other in _in_other_letters(folder, name):
                found = other.resolve()
                if found.is_relative_to(self.root) and found.is_file():
                    return found
        if outside:
            raise InputError.at(
                place,
                f'"{name[:200]}" leads out of {self.root}; nothing outside is read. '
                "Name a folder that holds everything with --root",
            )
        raise InputError.at(place, f'no file "{name[:200]}"')

    def folder(self, name: str, base: Path, place: str) -> Path:
        """Return a folder to look for files in. Raises InputError as `find` does."""
        found = (base / name.replace("\\", "/")).resolve()
        if not found.is_relative_to(self.root):
            raise InputError.at(
                place,
                f'"{name[:200]}" leads out of {self.root}; name a folder that holds everything with --root',
            )
        if not found.is_dir():
            raise InputError.at(place, f'no folder "{name[:200]}"')
        return found

    def shown(self, file: Path) -> str:
        """A file's name in messages, relative to the root."""
        return str(file.relative_to(self.root)) if file.is_relative_to(self.root) else file.name


def _in_other_letters(folder: Path, name: str) -> list[Path]:
    """Files whose path has the parts of a name in capitals or small letters, in the order of the names."""
    found = [folder]
    for part in Path(name).parts:
        if part == "..":
            found = [each / part for each in found]
            continue
        found = [
            entry
            for each in found
            if each.is_dir()
            for entry in sorted(each.iterdir())
            if entry.name.casefold() == part.casefold()
        ]
    return found


def read_bytes(file: Path, most: int, shown: str) -> bytes:
    """Return a file's content. Raises InputError where it has more than `most` bytes or can't be read."""
    try:
        with file.open("rb") as opened:
            # Memory for all that is asked for is taken beforehand.
            content = opened.read(min(most, os.fstat(opened.fileno()).st_size) + 1)
    except OSError as error:
        raise InputError.at(shown, f"can't be read: {error.strerror}") from None
    if len(content) > most:
        raise InputError.at(shown, f"has more than {most:,} bytes")
    return content


def read_text(file: Path, shown: str) -> str:
    """Return a file's text, whose lines end in LF. Raises InputError where it is too long or no text."""
    try:
        return text_of(io.BytesIO(read_bytes(file, TEXT_BYTES, shown))).read()
    except UnicodeError as error:
        raise InputError.at(shown, f"is no text: {error}") from None
