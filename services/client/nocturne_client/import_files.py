"""Which files belong to a scene of another renderer: itself, and those next to it that it names."""

import codecs
import gzip
import html
import re
import zlib
from collections import defaultdict
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from urllib.parse import unquote

from nocturne_client.errors import NocturneClientError
from nocturne_client.scene_files import digest

# Those that name no other files.
_ALONE = (".glb", ".rad", ".zip")
# Those that may name others; all of their formats but OBJ put names into quotes.
_TEXTS = (".xml", ".pbrt", ".pbrt.gz", ".gltf", ".obj")
_QUOTED = [
    re.compile(b"(?<=[%s])[^%s\\r\\n]{1,1024}(?=[%s])" % (3 * (quote,))) for quote in (b'"', b"'", b"\"'")
]
_QUOTED.append(re.compile(rb"(?m)(?<=^mtllib )[^\r\n]{1,1024}"))
"""The text between two quotes, and between a closing one and the next: an apostrophe in a comment hides
nothing."""
# The service takes no more.
_MAX_FILES = 10_000
_MAX_BYTES = 4 * 2**30
_MAX_TEXT_BYTES = 2**30
# Of a folder that are looked at; a home folder has millions.
_MAX_LOOKED_AT = 200_000


def files_of_import(scene: Path) -> dict[str, tuple[str, Path]]:
    """The files to upload for an import: SHA-256 and file by the path below the scene's folder.

    A .glb, .rad or .zip file alone; with others the files of their folder and of those below whose names
    stand in quotes in the scene, or in a file of scenes that is named there, and links to files of the
    folder. Nothing else leaves the machine. Raises NocturneClientError for unreadable files, and for too
    many.
    """
    try:
        if scene.name.lower().endswith(_ALONE):
            return {scene.name: (digest(scene), scene)}
        if not scene.is_file():
            raise NocturneClientError(f"{scene}: no such file")
        found = _named_from(scene, _by_name(scene.parent))
        if len(found) > _MAX_FILES or sum(file.stat().st_size for file in found) > _MAX_BYTES:
            raise NocturneClientError(
                f"{scene}: names more than {_MAX_FILES} files or {_MAX_BYTES // 2**30} GiB, more than an "
                "import takes; import it with `nocturne import`, and submit the scene.json"
            )
        return {file.relative_to(scene.parent).as_posix(): (digest(file), file) for file in found}
    except OSError as error:
        raise NocturneClientError(f"{error.filename or scene}: {error.strerror or error}") from error


def _by_name(folder: Path) -> dict[str, list[Path]]:
    """The folder's files, and those below, by the last part of their paths, in whichever letters."""
    files: defaultdict[str, list[Path]] = defaultdict(list)
    for count, file in enumerate(_below(folder, folder.resolve(), ())):
        if count == _MAX_LOOKED_AT:
            raise NocturneClientError(
                f"{folder}: holds more than {_MAX_LOOKED_AT} files; put the scene and the files that it "
                "names into a folder of their own, or into a .zip"
            )
        if file.is_file():
            files[file.name.casefold()].append(file)
    return files


def _below(folder: Path, root: Path, above: tuple[Path, ...]) -> Iterator[Path]:
    """The contents of a folder and of those below; links only where they lead to something else below `root`.

    `above`: the folders around it, without links.
    """
    above = (*above, folder.resolve())
    try:
        entries = list(folder.iterdir())
    except PermissionError:
        # An unreadable file is no part of the scene, unless it is named.
        return
    for entry in entries:
        if entry.is_symlink() and not entry.resolve().is_relative_to(root):
            continue
        yield entry
        if entry.is_dir() and entry.resolve() not in above:
            yield from _below(entry, root, above)


def _named_from(scene: Path, files: dict[str, list[Path]]) -> list[Path]:
    """The scene and all that it names, in the order of their paths."""
    found, left = {scene}, [scene]
    while left:
        for name in _names_in(left.pop()):
            new = [file for file in files.get(name.casefold(), ()) if file not in found]
            found.update(new)
            left += [file for file in new if file.name.lower().endswith(_TEXTS)]
    return sorted(found)


def _names_in(text: Path) -> set[str]:
    """Last parts of all that stands in quotes, as it is and without the escapes of URIs and XML."""
    try:
        with gzip.open(text) if text.name.lower().endswith(".gz") else text.open("rb") as stream:
            content = stream.read(_MAX_TEXT_BYTES + 1)
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise NocturneClientError(f"{text}: can't be unpacked: {error}") from error
    if len(content) > _MAX_TEXT_BYTES:
        raise NocturneClientError(f"{text}: has more than {_MAX_TEXT_BYTES // 2**30} GiB of text")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        content = content.decode("utf-16", "replace").encode()
    names: set[str] = set()
    for match in chain.from_iterable(quoted.finditer(content) for quoted in _QUOTED):
        try:
            quoted = match[0].decode()
        except UnicodeDecodeError:
            quoted = match[0].decode("latin-1")
        for each in (quoted, unquote(quoted), html.unescape(quoted)):
            names.add(re.split(r"[/\\]", each)[-1])
    return names
