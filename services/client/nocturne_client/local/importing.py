"""`nocturne import`: scenes of other renderers become scene documents, without a service."""

from collections.abc import Mapping
from pathlib import Path

from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.reading.options import Imported, ImportOptions

from nocturne_client.errors import NocturneClientError, Problem


def options(
    root: Path | None,
    parameters: Mapping[str, str],
    light_radius: float | None,
    light_degrees: float,
    light: str | None,
    time: float | None,
    allow_missing: bool,
) -> ImportOptions:
    """What was asked for."""
    return ImportOptions(root, parameters, light_radius, light_degrees, light, time, allow_missing)


def import_to(file: Path, folder: Path, options: ImportOptions) -> Imported:
    """Write the scene of `file` into `folder`. Raises NocturneClientError with all problems."""
    try:
        return import_scene(file, folder, options)
    except InputError as error:
        problems = [Problem(each.place, each.message) for each in error.problems]
        said = f"{file} can't be imported"
        if isinstance(error, Incomplete):
            said += f" as it is; {error.imported.document} holds the rest, to be edited"
            if error.imported.missing and not options.allow_missing:
                said += " or, as with --allow-missing, to be rendered without what is missing"
        raise NocturneClientError(said, problems=problems) from error
    except OSError as error:
        raise NocturneClientError(f"{error.filename or folder}: {error.strerror}") from error


def report(imported: Imported) -> list[str]:
    """Lines that say what was changed, what is missing, and how to go on."""
    lines = [f"note: {note}" for note in imported.notes]
    lines += [f"missing: {loss}" for loss in imported.missing]
    film = imported.film
    size = f"--width {film.width} --height {film.height}"
    samples = f" --samples {film.samples}" if film.samples else ""
    return [*lines, f"render it with: nocturne render {imported.document} -o OUT.exr {size}{samples}"]
