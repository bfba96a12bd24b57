"""A scene document in, a folder with another renderer's scene out."""

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.write import export_mitsuba
from nocturne_scene.formats.pbrt.write import export_pbrt
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.writing.compiled import Compiled

Exporter = Callable[[Compiled, SceneWriter, Film], str]

FORMATS: dict[str, Exporter] = {"mitsuba": export_mitsuba, "pbrt": export_pbrt}
"""Exporters by the renderer's name."""


@dataclass(frozen=True)
class Exported:
    """A scene that was written to a folder."""

    scene: Path
    notes: list[str]
    """Small differences of the other renderer's image."""
    missing: list[Problem]
    """Parts without a counterpart there; empty unless that was allowed."""


def export_scene(
    document: SceneDocument,
    blobs: BlobStore,
    folder: Path,
    renderer: str,
    film: Film,
    *,
    allow_missing: bool = False,
) -> Exported:
    """Make `folder`, which must not exist or be empty, with the scene for a renderer of `FORMATS`.

    `blobs` holds the files that the document names. Raises InputError: the document is wrong, or (without
    `allow_missing`) something in it has no counterpart there; then nothing is left behind.
    """
    if renderer not in FORMATS:
        raise InputError.at(renderer, f"expected one of {', '.join(FORMATS)}")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError.at(str(folder), "exists and is not an empty folder")
    if not folder.absolute().parent.is_dir():
        raise InputError.at(str(folder.absolute().parent), "no such folder")
    sha256 = compile_scene(document, blobs).scene_sha256
    message = scene_pb2.CompiledScene.FromString(blobs.path(sha256).read_bytes())
    findings = Findings()
    compiled = Compiled(message, blobs, document, findings)
    _report_hidden(message, findings)
    if message.ray_sets:
        findings.lost("$.ray_files", "lamps as the rays of a file have no equal; they are left out")
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=".export-") as kept:
        writer = SceneWriter(Path(kept) / "scene")
        writer.folder.mkdir()
        name = FORMATS[renderer](compiled, writer, film)
        if not allow_missing:
            findings.refuse_losses()
        if folder.exists():
            folder.rmdir()
        shutil.move(writer.folder, folder)
    return Exported(folder / name, findings.notes, findings.losses)


def _report_hidden(message: scene_pb2.CompiledScene, findings: Findings) -> None:
    hidden = {message.environment.hidden_from}
    hidden |= {luminaire.hidden_from for luminaire in message.luminaires}
    hidden |= {disc.hidden_from for disc in message.distant_discs}
    if scene_pb2.HIDDEN_FROM_CAMERA in hidden:
        findings.lost("$", "a light that is hidden from the camera is not supported; it is seen there")
    if scene_pb2.HIDDEN_FROM_CAMERA_AND_MIRRORS in hidden:
        findings.note("$", "lamps that stand for such without a size are seen by the camera and in mirrors")
