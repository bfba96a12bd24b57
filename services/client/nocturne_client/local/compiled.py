"""Compiles a scene into a folder, without a service."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_layers, compile_scene
from nocturne_scene.compile.layers import usual_layers
from nocturne_scene.document.changes import changed
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import film_size
from nocturne_scene.film import Film
from nocturne_scene.layers import known_layers
from nocturne_scene.ranges import make_schedule
from nocturne_scene.render_warnings import RenderWarning
from nocturne_scene.scene_ranges import schedule_for_scene

from nocturne_client.local.failures import client_errors
from nocturne_client.scene_files import SceneOnDisk, read_scene

_READ_BYTES = 1024 * 1024


@dataclass(frozen=True)
class CompiledFolder:
    """What nocturne-trace takes."""

    scene: Path
    schedule: Path
    blobs: Path
    scene_sha256: str
    dropped: tuple[str, ...] = ()
    """What the compiler left out, with its place."""
    warnings: tuple[RenderWarning, ...] = ()
    """What of the scene can hardly be meant, with its place, and what the image may not show."""
    way: str = ""
    """How it is traced and why, where a pilot chose."""
    layers: Path | None = None
    """The layers' file, where the image has any layers."""

    def said(self) -> list[str]:
        """How the scene is traced, where that was chosen, and a line for each warning."""
        chosen = [f"traced by {self.way}"] if self.way else []
        return [*chosen, *(f"warning: {each.sentence}" for each in self.warnings)]


def compile_to(
    scene: Path,
    folder: Path,
    width: int,
    height: int,
    samples: int,
    seed: int | None = None,
    layers: Sequence[str] | None = None,
    changes: Mapping[str, Any] | None = None,
    name: str = "",
) -> CompiledFolder:
    """Writes scene.pb, schedule.pb and blobs/ into `folder`. Raises NocturneClientError with all problems.

    `seed` instead of the scene's own. `layers`: see `nocturne_scene.layers`; in addition, those that are
    made without being asked for; None: none at all. `changes`: see `nocturne_scene.document.changes`.
    `name`: what errors call the scene; empty: its path.
    """
    made = {**(changes or {}), **({} if seed is None else {"tracing.seed": seed})}
    return compile_parts(
        read_scene(scene), folder, (width, height), samples, made, name or str(scene), layers
    )


def compile_parts(
    on_disk: SceneOnDisk,
    folder: Path,
    film: tuple[int, int],
    samples: int,
    changes: Mapping[str, Any],
    name: str,
    layers: Sequence[str] | None = None,
) -> CompiledFolder:
    """The same of a document that is read, with its files."""
    width, height = film
    with client_errors(f"{name} can't be rendered"):
        # Problems of the film are reported before the work.
        make_schedule(width, height, samples)
        document = check_document(changed(on_disk.document, changes))
        folder.mkdir(parents=True, exist_ok=True)
        blobs = BlobStore(folder / "blobs", durable=False)
        store_files(on_disk, blobs)
        width, height = film_size(document.sensor, width, height)
        whole = Film(width, height, samples)
        names = () if layers is None else known_layers((*layers, *usual_layers(document, whole)))
        output = compile_scene(document, blobs, whole)
        sha256 = output.scene_sha256
        schedule = schedule_for_scene(blobs, sha256, width, height, samples)
        files = folder / "scene.pb", folder / "schedule.pb", folder / "blobs"
        of_film = blobs.path(compile_layers(document, blobs, whole, names)) if names else None
        said = tuple(output.dropped), tuple(output.warnings), output.way
        compiled = CompiledFolder(*files, sha256, *said, of_film)
        compiled.scene.write_bytes(blobs.path(sha256).read_bytes())
        compiled.schedule.write_bytes(schedule.SerializeToString(deterministic=True))
    return compiled


def store_files(scene: SceneOnDisk, blobs: BlobStore) -> None:
    """Puts the files that a scene names into a blob store."""
    for sha256, path in scene.files.items():
        with path.open("rb") as file, blobs.writer(sha256, path.stat().st_size) as writer:
            while piece := file.read(_READ_BYTES):
                writer.write(piece)
