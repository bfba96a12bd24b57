"""`nocturne export`: scene documents become scenes of other renderers, without a service."""

import tempfile
from pathlib import Path

from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.read import check_document
from nocturne_scene.film import Film
from nocturne_scene.formats.export_scene import Exported, export_scene
from nocturne_scene.ranges import make_schedule

from nocturne_client.local.compiled import store_files
from nocturne_client.local.failures import client_errors
from nocturne_client.scene_files import read_scene


def export_to(
    scene: Path, folder: Path, renderer: str, film: Film, *, allow_missing: bool = False
) -> Exported:
    """Write the scene for another renderer into `folder`. Raises NocturneClientError with all problems."""
    on_disk = read_scene(scene)
    with client_errors(f"{scene} can't be exported to {renderer}; with --allow-missing the rest is"):
        make_schedule(film.width, film.height, film.samples)
        document = check_document(on_disk.document)
        with tempfile.TemporaryDirectory(prefix="nocturne-export-") as kept:
            blobs = BlobStore(Path(kept), durable=False)
            store_files(on_disk, blobs)
            return export_scene(document, blobs, folder, renderer, film, allow_missing=allow_missing)


def report(exported: Exported) -> list[str]:
    """Lines that say in what the other renderer's image differs."""
    return [f"note: {note}" for note in exported.notes] + [f"missing: {loss}" for loss in exported.missing]
