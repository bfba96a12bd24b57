"""Any format in, a folder with a scene document and its files out."""

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError, Problem
from nocturne_scene.formats import archives
from nocturne_scene.formats.reading.environments import light_up
from nocturne_scene.formats.reading.findings import SHOWN, Findings
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.formats.reading.scene_writer import DOCUMENT, SceneWriter

Importer = Callable[[Path, SceneWriter, Findings, ImportOptions], None]


# Each is imported with its first scene: with scipy and trimesh they take longer than a small scene takes to
# render, and every command that takes any scene knows their names.


def _mitsuba(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    from nocturne_scene.formats.mitsuba.read import import_mitsuba

    import_mitsuba(file, writer, findings, options)


def _pbrt(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    from nocturne_scene.formats.pbrt.read import import_pbrt

    import_pbrt(file, writer, findings, options)


def _gltf(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    from nocturne_scene.formats.gltf.read import import_gltf

    import_gltf(file, writer, findings, options)


def _radiance(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    from nocturne_scene.formats.radiance.read import import_radiance

    import_radiance(file, writer, findings, options)


def _obj(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    from nocturne_scene.formats.wavefront.read import import_obj

    import_obj(file, writer, findings, options)


FORMATS: dict[str, Importer] = {
    ".xml": _mitsuba,
    ".pbrt": _pbrt,
    ".pbrt.gz": _pbrt,
    ".gltf": _gltf,
    ".glb": _gltf,
    ".rad": _radiance,
    ".obj": _obj,
}
"""Importers by the end of a file's name."""

ENDS = (*FORMATS, archives.END)
"""Of all files that can be imported."""

# Parts of a document of which one at least is in every scene.
_SEEN = ("surfaces", "instances", "unbounded_media", "atmosphere")

# Beside a document that lacks something: its digest.
_DRAFT = ".incomplete"


class Incomplete(InputError):
    """A scene was written that lacks something: it is there to be edited."""

    def __init__(self, problems: Iterable[Problem], imported: Imported) -> None:
        super().__init__(problems)
        self.imported = imported


def import_scene(file: Path, folder: Path, options: ImportOptions) -> Imported:
    """Make `folder`, which must not exist or be empty, with the scene that `file` describes or, a ZIP
    archive, holds.

    Raises Incomplete: the folder is there, but (without `allow_missing`) something in the file has no
    counterpart here, or the document is one that can't be rendered. Raises InputError for a file that can't
    be imported at all; then nothing is left behind.
    """
    if not file.is_file():
        raise InputError.at(str(file), "no such file")
    if file.name.lower().endswith(archives.END):
        with tempfile.TemporaryDirectory(prefix="nocturne-import-") as unpacked:
            names = archives.unpack(file, Path(unpacked))
            name = archives.scene_among(names, FORMATS, str(file), Path(unpacked))
            return import_scene(Path(unpacked) / name, folder, replace(options, root=Path(unpacked)))
    importer = next((found for end, found in FORMATS.items() if file.name.lower().endswith(end)), None)
    if importer is None:
        raise InputError.at(str(file), f"expected a file that ends in {', '.join(ENDS)}")
    root = options.root or file.parent
    if not file.resolve().is_relative_to(root.resolve()):
        raise InputError.at(str(file), f"lies outside of {root}")
    if folder.exists() and not _may_be_replaced(folder):
        raise InputError.at(str(folder), "exists and is not an empty folder")
    if not folder.absolute().parent.is_dir():
        raise InputError.at(str(folder.absolute().parent), "no such folder")
    findings = Findings()
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=".import-") as kept:
        writer = SceneWriter(Path(kept) / "scene")
        writer.folder.mkdir()
        writer.document |= {"name": file.stem, "note": ""}
        # What overflows is infinite, and refused where it is written.
        with np.errstate(all="ignore"):
            _read(importer, file, writer, findings, options)
        _describe(writer, findings)
        problems = list(writer.finish())
        if findings.losses and (problems or not options.allow_missing):
            problems = [*findings.losses, *problems]
        if problems:
            (writer.folder / _DRAFT).write_text(_digest(writer.folder))
        if folder.exists():
            shutil.rmtree(folder)
        shutil.move(writer.folder, folder)
    imported = Imported(folder / DOCUMENT, writer.film, findings.notes, findings.losses)
    if problems:
        raise Incomplete(problems[:SHOWN], imported)
    return imported


def _may_be_replaced(folder: Path) -> bool:
    """Whether a folder is empty, or what an incomplete import left there and nobody has edited."""
    if not folder.is_dir() or folder.is_symlink():
        return False
    if not any(folder.iterdir()):
        return True
    try:
        return (folder / _DRAFT).read_text() == _digest(folder)
    except (OSError, UnicodeDecodeError):
        return False


def _digest(folder: Path) -> str:
    return hashlib.sha256((folder / DOCUMENT).read_bytes()).hexdigest()


def _read(
    importer: Importer, file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions
) -> None:
    try:
        importer(file, writer, findings, options)
        if findings.losses and not any(writer.document.get(kind) for kind in _SEEN):
            raise InputError.at("", "nothing is left of the scene")
        writer.leave_out_unseen(findings)
        light_up(writer, findings, options.light)
    except InputError as error:
        # Earlier losses are the cause, more often than not.
        raise InputError([*findings.losses, *error.problems][:SHOWN]) from None


def _describe(writer: SceneWriter, findings: Findings) -> None:
    film = writer.film
    lines = [f"Imported; its film has {film.width} x {film.height} pixels."]
    lines += findings.notes
    lines += [f"missing: {loss}" for loss in findings.losses]
    writer.document["note"] = "\n".join(lines)[:20_000]
