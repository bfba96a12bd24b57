"""`nocturne goniometer`: the intensities of a lamp in a scene as a photometric file, with their errors."""

import csv
import io
import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from nocturne_scene.photometry import far_field, tm25
from nocturne_scene.photometry.meter_images import errors_of, flux_of

from nocturne_client.console import ERRORS
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.photometry import WRITERS, MeterImage, read_meter_image
from nocturne_client.local.render import LocalRender, render_scene
from nocturne_client.outputs import check_output, written
from nocturne_client.readings import CONFIDENCE, rounded

RAY_FILE = ".tm25ray"
"""How names of ray files end, in letters of either case."""


@dataclass(frozen=True)
class Goniometer:
    """The measurement asked for, and its output files."""

    scene: Path
    """Or a ray file, of which the far field is taken."""
    outputs: Sequence[Path]
    """Photometric files, by their endings."""
    table: Path
    """Where the table of angles goes, CSV."""
    horizontal: int
    vertical: int
    """How many angles of each kind."""
    samples: int
    threads: int
    seed: int | None
    stop: Mapping[str, Any]
    changes: Mapping[str, Any]


def measure_lamp(asked: Goniometer) -> None:
    """Traces the scene's intensity meter, or takes the rays of a file, and writes the files. Raises
    NocturneClientError."""
    for path in asked.outputs:
        if path.suffix.lower() not in WRITERS:
            raise NocturneClientError(f"{path}: expected a name that ends in {', '.join(WRITERS)}")
    for path in (*asked.outputs, asked.table):
        check_output(path)
    if asked.scene.suffix.lower() == RAY_FILE:
        _write_files(asked, _of_rays(asked))
        return
    check_sensor(asked.scene, asked.changes)
    with tempfile.TemporaryDirectory(prefix="nocturne-goniometer-") as folder:
        image = Path(folder) / "image.exr"
        film = asked.horizontal, asked.vertical, asked.samples
        render = LocalRender(asked.scene, [image], *film, asked.threads, asked.seed)
        render_scene(replace(render, stop=asked.stop, changes=asked.changes))
        found = read_meter_image(image)
    _write_files(asked, found)


def _of_rays(asked: Goniometer) -> MeterImage:
    """The far field of a ray file. Raises NocturneClientError."""
    try:
        rays = tm25.read(asked.scene)
        candela, error = far_field.candela_of(rays, asked.horizontal, asked.vertical)
    except (tm25.BadRayFileError, ValueError) as problem:
        raise NocturneClientError(f"{asked.scene}: {problem}") from problem
    except OSError as problem:
        raise NocturneClientError(f"{asked.scene}: {problem.strerror or problem}") from problem
    keywords = {
        "TEST": f"far field of {len(rays.starts)} rays",
        "TESTLAB": "not said",
        "ISSUEDATE": "not said",
        "MANUFAC": rays.texts[1] or "not said",
        "LUMINAIRE": rays.texts[0],
        "OTHER": f"standard errors up to {error.max():.3g} cd",
    }
    known = {key: text for key, text in keywords.items() if text}
    return MeterImage(candela, error, {}, known, far_field.spectrum_of(rays))


def _write_files(asked: Goniometer, found: MeterImage) -> None:
    try:
        lamp = found.photometry()
        made = {path: WRITERS[path.suffix.lower()](lamp) for path in asked.outputs}
    except ValueError as problem:
        raise NocturneClientError(f"{asked.scene}: {problem}") from problem
    for path, data in made.items():
        _write(path, data)
    _write(asked.table, table_of(found).encode())
    _say(found)


def table_of(found: MeterImage) -> str:
    """Angles, intensities and their standard errors, RFC 4180, in the order of the photometric files."""
    lines: list[Sequence[float | str]] = [
        ("horizontal_degrees", "vertical_degrees", "candela", "standard_error")
    ]
    lamp, errors = found.photometry(), errors_of(found.error)
    for horizontal, values, of_values in zip(lamp.horizontal, lamp.candela, errors, strict=True):
        for vertical, value, error in zip(lamp.vertical, values, of_values, strict=True):
            lines.append((f"{horizontal:.8g}", f"{vertical:.8g}", f"{value:.8g}", f"{error:.8g}"))
    text = io.StringIO()
    csv.writer(text).writerows(lines)
    return text.getvalue()


def check_sensor(scene: Path, changes: Mapping[str, Any]) -> None:
    """Raises NocturneClientError where the sensor is no intensity meter."""
    if "sensor" in changes:
        return
    try:
        sensor = json.loads(scene.read_text()).get("sensor", {})
    except (OSError, ValueError, AttributeError):
        return  # told where it is compiled
    kind = sensor.get("type") if isinstance(sensor, dict) else None
    if kind != "intensity_meter":
        raise NocturneClientError(
            f"{scene}: the sensor is {kind}; expected an intensity_meter, or --centre and --radius of "
            "the sphere that holds the lamp"
        )


def _write(path: Path, data: bytes) -> None:
    try:
        with written(path) as file:
            file.write(data)
    except OSError as problem:
        raise NocturneClientError(f"{path}: {problem.strerror}") from problem


def _say(found: MeterImage) -> None:
    lumens, error = flux_of(found.candela, found.error)
    most = found.candela.argmax()
    at_most, its_error = float(found.candela.flat[most]), float(found.error.flat[most])
    largest = float(found.error.max())
    part = f", {largest / at_most:.2%} of that" if at_most > 0.0 else ""
    ERRORS.print(
        f"{rounded(lumens, 5)} +- {rounded(CONFIDENCE * error, 2)} lm, at most {rounded(at_most, 5)} +- "
        f"{rounded(CONFIDENCE * its_error, 2)} cd (95 %); no angle's standard error is above "
        f"{rounded(largest, 2)} cd{part}",
        markup=False,
        soft_wrap=True,
    )
