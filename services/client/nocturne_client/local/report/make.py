"""Makes the report of an image: measures, checks a requirement, draws plans."""

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compare.images import read_picture
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.read import check_document
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.writing.compiled import Compiled, array
from nocturne_scene.photometry.places import ATTRIBUTE, Places
from nocturne_scene.photometry.requirements import Requirement
from nocturne_scene.quantities import ILLUMINANCE, quantity_named

from nocturne_client.contract import Glare
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import store_files
from nocturne_client.local.failures import client_errors
from nocturne_client.local.report.contents import INTERVALS, Report, Section, Table
from nocturne_client.local.report.grid_values import GridValues, grids_of
from nocturne_client.local.report.judging import checks_of, judged
from nocturne_client.local.report.plan import plan
from nocturne_client.local.report.plan_lines import Frame, PlanLines, plan_lines
from nocturne_client.local.report.scene_parts import lamps_of, materials_of
from nocturne_client.local.report.sections import (
    annual_section,
    glare_section,
    lamp_section,
    material_section,
    readings_section,
)
from nocturne_client.scene_files import SceneOnDisk
from nocturne_client.version import installed_version

_SHORT = 16
"""Of a digest that is printed in a line with others."""


@dataclass(frozen=True)
class Asked:
    """What a report is made of."""

    image: Path
    name: str
    """Of the image or the render, for people."""
    scene: SceneOnDisk | None
    requirement: Requirement | None
    task: str
    """The instrument that a requirement is for; empty: the first grid of a plane."""
    glares: Sequence[tuple[str, Glare]]
    annual: Mapping[str, Any] | None
    title: str


def make(asked: Asked, now: datetime | None = None) -> Report:
    """Raises NocturneClientError."""
    header = _header(asked.image)
    with client_errors(f"{asked.name} can't be reported on"):
        picture = read_picture(asked.image)
        quantity = quantity_named(header("nocturne:quantity"))
        if picture.moments is None or quantity is not ILLUMINANCE:
            raise NocturneClientError(
                f"{asked.name}: expected an image of ours of the sensor meters or irradiance_meter, which "
                f"measure illuminance; found {quantity.name or 'no quantity and no errors'}"
            )
        height, width = picture.moments.samples.shape
        places = Places.read(header(ATTRIBUTE), width, height)
        if not places.parts:
            raise NocturneClientError(f"{asked.name}: the image does not say where its meters are")
        grids = grids_of(picture.moments, places, picture.names, quantity)
        if not grids:
            raise NocturneClientError(f"{asked.name}: no meter has a sample yet")
        document = None if asked.scene is None else check_document(asked.scene.document)
        lines = _lines(asked.scene, document, grids)
    task = _task(grids, asked.task)
    samples = int(picture.moments.samples.max())
    report = Report(
        asked.title or (document.name if document and document.name else Path(asked.name).stem),
        _facts(asked, header, samples, now or datetime.now(UTC)),
        warnings=_warnings(header),
    )
    if asked.requirement is not None:
        report.requirement = asked.requirement.name
        checks = checks_of(asked.requirement, task, grids, asked.glares, asked.annual)
        report.checks, report.whole = judged(checks, is_trusted=not header("nocturne:errorWarning"))
    for index, grid in enumerate(grids):
        if grid.is_grid:
            report.sections.append(_grid_section(grid, lines.get(index)))
    if points := [grid for grid in grids if not grid.is_grid]:
        report.sections.append(readings_section(points))
    report.sections += [glare_section(asked.glares)] if asked.glares else []
    report.sections += [annual_section(asked.annual)] if asked.annual is not None else []
    if document is not None and asked.scene is not None:
        report.sections.append(lamp_section(lamps_of(document, asked.scene.files)))
        report.sections.append(material_section(materials_of(document)))
    report.sections.append(_basis(asked, header, samples))
    return report


def _grid_section(grid: GridValues, drawn: tuple[Frame, PlanLines] | None) -> Section:
    section = readings_section([grid])
    section.title = f"Illuminance: {grid.part.name}"
    frame, lines = drawn or (Frame.of(grid.part), PlanLines())
    title = f"plan of {grid.part.name} with illuminances in lx"
    section.drawings.append(plan(grid, frame, lines, title))
    size = f"{grid.part.columns} x {grid.part.rows} values on {frame.width:g} m x {frame.height:g} m"
    what = "means over cells of the film" if grid.part.name == "film" else "meters"
    section.notes.append(
        f"{size}, {what}. Colours and numbers are values as they were found; red lines are of values "
        "smoothed as far as noise explains their differences (Lee 1980). Thick: what the plane "
        "cuts; thin: what lies below; orange, dashed: luminaires."
    )
    return section


def _task(grids: Sequence[GridValues], name: str) -> GridValues:
    names = [each.part.name for each in grids]
    if name:
        if name not in names:
            raise NocturneClientError(f"--task {name}: expected one of {', '.join(names)}")
        return grids[names.index(name)]
    planes = [each for each in grids if each.is_grid and each.part.measures == "plane"]
    return (planes or list(grids))[0]


def _lines(
    scene: SceneOnDisk | None, document: SceneDocument | None, grids: Sequence[GridValues]
) -> dict[int, tuple[Frame, PlanLines]]:
    """By the number of the grid."""
    wanted = {index: Frame.of(grid.part) for index, grid in enumerate(grids) if grid.is_grid}
    if scene is None or document is None or not wanted:
        return {}
    with tempfile.TemporaryDirectory(prefix="nocturne-report-") as folder:
        blobs = BlobStore(Path(folder), durable=False)
        store_files(scene, blobs)
        output = compile_scene(document, blobs)
        message = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
        compiled = Compiled(message, blobs, document, Findings())
        shift = np.array(document.sensor.position) - array(message.sensor.position)
        return {index: (frame, plan_lines(compiled, frame, shift)) for index, frame in wanted.items()}


class _header:  # noqa: N801 - a function with a memory
    """The header of an EXR; empty where a name is not there."""

    def __init__(self, image: Path) -> None:
        picture = oiio.ImageInput.open(str(image))
        if picture is None:
            oiio.geterror()
            raise NocturneClientError(f"{image}: no image that can be read")
        self._spec = picture.spec()
        picture.close()

    def __call__(self, name: str) -> str:
        return str(self._spec.getattribute(name) or "")


def _facts(asked: Asked, header: _header, samples: int, now: datetime) -> list[str]:
    made = f"Nocturne {installed_version()}, engine {header('nocturne:engine') or 'not told'}"
    scene = header("nocturne:scene")
    return [
        f"{asked.name}; {samples:,} samples a meter; {made}; {now:%Y-%m-%d %H:%M} UTC",
        f"Scene {scene[:_SHORT]}… (SHA-256)" if scene else "The image does not tell the digest of its scene.",
        INTERVALS,
    ]


def _warnings(header: _header) -> list[str]:
    found = header("nocturne:warnings").splitlines()
    if error_warning := header("nocturne:errorWarning"):
        found.insert(
            0,
            f"The errors of this image are not to be trusted, and no requirement is decided: {error_warning}",
        )
    return found


def _basis(asked: Asked, header: _header, samples: int) -> Section:
    rows = [
        ("image", asked.name),
        ("scene, SHA-256 of the compiled scene", header("nocturne:scene") or "-"),
        ("engine", header("nocturne:engine") or "-"),
        ("floating-point profile", header("nocturne:floatingPointProfile") or "-"),
        ("samples of each pixel", f"{samples:,}"),
        ("wavelengths", header("nocturne:wavelengths") or "-"),
        ("method", header("nocturne:way") or "as the scene says"),
        ("program", f"Nocturne {installed_version()}"),
    ]
    notes = [
        "Equal scene, engine, profile and samples give this image again, bit by bit.",
        "U0 is the least over the mean of the values. Its least is without what the choice among noisy "
        "values makes it too low by; its interval is made so that no smoothness of the light is needed.",
        "A requirement holds, or does not, from 95 % on; between, it is open. Probabilities of several "
        "limits together are what is left of their doubts (Bonferroni).",
    ]
    if asked.scene is None:
        notes.append("No scene document was given: outlines, luminaires and materials are missing.")
    return Section("Basis", tables=[Table(("", ""), rows, texts=2)], notes=notes)


def read_annual(path: Path) -> dict[str, Any]:
    """What `nocturne annual -o FILE.json` wrote. Raises NocturneClientError."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(found, dict) or "sDA" not in found or "means" not in found:
            raise ValueError
    except OSError as error:
        raise NocturneClientError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise NocturneClientError(f"{path}: expected a file of nocturne annual -o FILE.json") from error
    return found
