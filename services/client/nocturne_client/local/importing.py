"""`nocturne import`: scenes of other renderers become scene documents, without a service."""

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.reading.options import Imported, ImportOptions

from nocturne_client.console import ERRORS
from nocturne_client.local.failures import client_errors
from nocturne_client.scene_files import is_of_other_renderer


def options(
    root: Path | None,
    parameters: Mapping[str, str],
    light_radius: float | None,
    light_degrees: float,
    light: str | None,
    time: float | None,
    allow_missing: bool,
) -> ImportOptions:
    """The options of an import."""
    return ImportOptions(root, parameters, light_radius, light_degrees, light, time, allow_missing)


def import_to(file: Path, folder: Path, options: ImportOptions, *, kept: bool = True) -> Imported:
    """Write the scene of `file` into `folder`. Raises NocturneClientError with all problems.

    `kept`: whether the folder stays for people to edit its contents.
    """

    def refused(error: InputError) -> str:
        said = f"{file} can't be imported"
        if isinstance(error, Incomplete) and not kept:
            said += "; --allow-missing leaves out unsupported parts" if error.imported.missing else ""
        elif isinstance(error, Incomplete):
            said += f" as it is; {error.imported.document} holds the rest, to be edited"
            if error.imported.missing and not options.allow_missing:
                said += " or, as with --allow-missing, to be rendered without what is missing"
        return said

    with client_errors(refused):
        return import_scene(file, folder, options)


@contextmanager
def imported_or_same(
    scene: Path, light: str, allow_missing: bool, edge: int
) -> Iterator[tuple[Path, tuple[int, int]]]:
    """A scene document, imported for as long as the block where `scene` is another renderer's; and its film,
    `edge` x `edge` pixels where it has none."""
    if not is_of_other_renderer(scene):
        yield scene, (edge, edge)
        return
    chosen = ImportOptions(light=light or None, allow_missing=allow_missing)
    with tempfile.TemporaryDirectory(prefix="nocturne-") as folder:
        imported = import_to(scene, Path(folder) / "scene", chosen, kept=False)
        for line in _changes(imported):
            ERRORS.print(line, markup=False, soft_wrap=True)
        yield imported.document, (imported.film.width, imported.film.height)


def report(imported: Imported) -> list[str]:
    """Lines that say which parts were changed, which are missing, and how to go on."""
    lines = _changes(imported)
    film = imported.film
    size = f"--width {film.width} --height {film.height}"
    samples = f" --samples {film.samples}" if film.samples else ""
    return [*lines, f"render it with: nocturne render {imported.document} -o OUT.exr {size}{samples}"]


def _changes(imported: Imported) -> list[str]:
    return [f"note: {note}" for note in imported.notes] + [f"missing: {loss}" for loss in imported.missing]
