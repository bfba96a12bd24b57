"""Grids: what the program that reads them says, where they stand, and the box around them."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film

from tests.scene.conftest import Compile, Document, files_in

FACTS: dict[str, Any] = {
    "name": "density",
    "index_box": [[2, 0, -1], [5, 3, 4]],
    # Voxels of 0.5 m, the first at (10, 0, 0).
    "transform": [0.5, 0, 0, 10, 0, 0.5, 0, 0, 0, 0, 0.5, 0],
    "least": 0.0,
    "most": 3.0,
}

# Stands for nocturne-grid: answers FACTS and writes the requested file; for a grid named "bad" it complains.
_PROGRAM = """#!{python}
import sys
verb, source, _, name, _, output = sys.argv[1:]
assert verb == "convert", verb
if name == "bad":
    sys.stderr.write("nocturne-grid: there is no grid of that name\\n")
    sys.exit(2)
open(sys.argv[0] + ".runs", "a").write(".")
open(output, "wb").write(name.encode() + b" of " + open(source, "rb").read())
print({facts!r})
"""


@pytest.fixture(autouse=True)
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "bin"
    folder.mkdir()
    file = folder / "nocturne-grid"
    _answer(file, FACTS)
    monkeypatch.setenv("NOCTURNE_BIN", str(folder))
    return file


def _answer(program: Path, facts: Document) -> None:
    program.write_text(_PROGRAM.format(python=sys.executable, facts=json.dumps(facts)))
    program.chmod(0o755)


def smoke(document: Document, blobs: BlobStore, **grid: Any) -> Document:
    """The document with a box of smoke, surface 3."""
    asset = f"sha256:{blobs.put(b'a file')}"
    document["media"] = {"smoke": {"scattering": 1, "density": {"asset": asset, "grid": "density", **grid}}}
    document["surfaces"].append(
        {"shape": {"type": "medium_box", "medium": "smoke"}, "interior": {"media": ["smoke"]}}
    )
    return document


def vertices(blobs: BlobStore, mesh: Any) -> Any:
    data = blobs.path(mesh.blob.hex()).read_bytes()
    return np.frombuffer(data, "<f4", 3 * mesh.vertex_count).reshape(-1, 3)


def test_a_grid_is_converted_and_stands_where_it_is_put(
    document: Document, blobs: BlobStore, compiled: Compile
) -> None:
    turn = {"axis": [0, 0, 1], "degrees": 90}
    where = {"scale": 2, "rotate": turn, "translate": [1, 0, 0], "factor": 5, "nearest": True}
    scene = compiled(smoke(document, blobs, **where))
    grid = scene.media[0].grid
    assert blobs.path(grid.blob.hex()).read_bytes() == b"density of a file"
    assert np.reshape(grid.transform, (3, 4)).tolist() == [[0, -2, 0, 1], [2, 0, 0, 0], [0, 0, 2, 0]]
    assert (grid.scale, grid.nearest) == (5, True)


@pytest.mark.parametrize(("nearest", "margin"), [(True, 0.5), (False, 1.0)])
def test_the_box_around_a_grid(
    document: Document, blobs: BlobStore, compiled: Compile, nearest: bool, margin: float
) -> None:
    """From voxels 2..5, 0..3, -1..4 with room; through the file's transform, then the placement."""
    scene = compiled(smoke(document, blobs, nearest=nearest, translate=[0, 100, 0]))
    found = vertices(blobs, scene.surfaces[3].mesh)
    low = np.array([10 + 0.5 * (2 - margin), 100 - 0.5 * margin, 0.5 * (-1 - margin)])
    high = np.array([10 + 0.5 * (5 + margin), 100 + 0.5 * (3 + margin), 0.5 * (4 + margin)])
    assert found.min(axis=0) == pytest.approx(low)
    assert found.max(axis=0) == pytest.approx(high)


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_boxes_normals_point_outwards(
    document: Document, blobs: BlobStore, compiled: Compile, program: Path, mirrored: bool
) -> None:
    if mirrored:
        _answer(program, {**FACTS, "transform": [-0.5, 0, 0, 10, 0, 0.5, 0, 0, 0, 0, 0.5, 0]})
    mesh = compiled(smoke(document, blobs)).surfaces[3].mesh
    points = vertices(blobs, mesh).astype(np.float64)
    data = blobs.path(mesh.blob.hex()).read_bytes()
    corners = points[np.frombuffer(data[12 * mesh.vertex_count :], "<u4").reshape(-1, 3)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = corners.mean(axis=1) - points.mean(axis=0)
    assert np.all(np.einsum("ij,ij->i", normals, outwards) > 0)


def test_fire_glows(document: Document, blobs: BlobStore, compiled: Compile) -> None:
    """It is the only light here, and its two grids are one blob each."""
    document = smoke(document, blobs)
    grid = {**document["media"]["smoke"]["density"], "grid": "temperature", "factor": 1000}
    document["media"]["smoke"] |= {"absorption": 2, "temperature": grid, "emission_scale": 0.5}
    del document["surfaces"][1]["luminaire"]
    [medium] = compiled(document).media
    assert medium.emission_scale == 0.5
    assert medium.temperature.scale == 1000
    assert blobs.path(medium.temperature.blob.hex()).read_bytes() == b"temperature of a file"


@pytest.mark.parametrize(
    "sensor",
    [
        {"type": "irradiance_meter", "position": [0, 1, 0], "normal": [0, -1, 0], "height": 0.5},
        {"type": "intensity_meter", "position": [0, 0, 0], "lamp_radius": 9},
    ],
)
def test_a_meter_beside_fire_counts_no_photons_of_luminaires(
    document: Document, blobs: BlobStore, compiled: Compile, sensor: Document
) -> None:
    """A film next to a lamp and glowing smoke read 34 lx by photons from luminaires, where 93 is right."""
    document = smoke(document, blobs)
    grid = {**document["media"]["smoke"]["density"], "grid": "temperature", "factor": 1000}
    document["media"]["smoke"] |= {"absorption": 2, "temperature": grid}
    document |= {"sensor": sensor, "tracing": {"direction": "auto", "sharing": 1}}
    # Large enough for a pilot, which is not asked.
    output = compile_scene(check_document(document), blobs, Film(64, 64, 64))
    assert output.way == ""
    document["tracing"]["direction"] = "forward"
    with pytest.raises(InputError, match=r"\$\.tracing\.direction: .*media glow.*expected \"adjoint\""):
        compiled(document)


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"grid": "bad"}, "$.media.smoke.density.asset", "there is no grid of that name"),
        ({"asset": "smoke.vdb"}, "$.media.smoke.density.asset", "the service has no paths"),
        ({"asset": "sha256:" + 64 * "0"}, "$.media.smoke.density.asset", "upload it first"),
        ({"translate": [1e13, 0, 0]}, "$.media.smoke.density.translate[0]", "at most"),
        ({"grid": ""}, "$.media.smoke.density.grid", "at least 1 characters"),
    ],
)
def test_a_mistake_is_told_with_its_place(
    document: Document, blobs: BlobStore, tmp_path: Path, change: Document, place: str, words: str
) -> None:
    document = smoke(document, blobs)
    document["media"]["smoke"]["density"] |= change
    del document["surfaces"][3]
    document["unbounded_media"] = ["smoke"]
    before = files_in(tmp_path)
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(document), blobs)
    [problem] = caught.value.problems
    assert problem.place == place
    assert words in problem.message
    assert files_in(tmp_path) == before


def _runs(program: Path) -> int:
    return len(program.with_name("nocturne-grid.runs").read_text())


def test_a_grid_is_converted_once_for_all_scenes(
    document: Document, blobs: BlobStore, compiled: Compile, program: Path
) -> None:
    first = compiled(smoke(document, blobs))
    document["media"]["smoke"]["density"]["factor"] = 2
    second = compiled(document)
    assert _runs(program) == 1
    assert second.media[0].grid.blob == first.media[0].grid.blob
    assert second.media[0].grid.scale == 2
    assert second.surfaces[3] == first.surfaces[3]
    # Another grid of the file, and the same of another file.
    document["media"]["smoke"]["density"]["grid"] = "heat"
    compiled(document)
    document["media"]["smoke"]["density"]["asset"] = f"sha256:{blobs.put(b'another file')}"
    compiled(document)
    assert _runs(program) == 3


@pytest.mark.parametrize("text", ["", "7", "[]", '["x", "{}"]', '["DIGEST", "{}"]', '["DIGEST", "nan"]'])
def test_a_damaged_note_is_no_note(
    document: Document, blobs: BlobStore, compiled: Compile, program: Path, text: str
) -> None:
    first = compiled(smoke(document, blobs))
    [note] = (blobs.root / "notes").glob("*/*")
    note.write_text(text.replace("DIGEST", first.media[0].grid.blob.hex()))
    assert compiled(document) == first
    assert _runs(program) == 2


def test_a_grid_that_is_gone_or_of_another_program_is_converted_again(
    document: Document, blobs: BlobStore, compiled: Compile, program: Path
) -> None:
    first = compiled(smoke(document, blobs))
    blob = blobs.path(first.media[0].grid.blob.hex())
    blob.unlink()
    assert compiled(document) == first
    assert blob.is_file()
    program.write_text(program.read_text() + "# another\n")
    assert compiled(document) == first
    assert _runs(program) == 3


def test_a_box_needs_a_grid_and_no_place(document: Document, blobs: BlobStore) -> None:
    document = smoke(document, blobs)
    document["media"]["fog"] = {"scattering": 1}
    document["surfaces"][3] |= {"shape": {"type": "medium_box", "medium": "fog"}, "scale": 2}
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(document), blobs)
    first, second = (str(problem) for problem in caught.value.problems)
    assert first == ('$.surfaces[3].shape.medium: the density of "fog" is no grid; expected one of "smoke"')
    assert second.startswith("$.surfaces[3].scale: the box stands where the medium's grid stands")


def test_a_box_is_not_in_a_group(document: Document, blobs: BlobStore) -> None:
    """Instances would leave its grid behind."""
    document = smoke(document, blobs)
    document["groups"] = {"cloud": [document["surfaces"].pop(3)]}
    document["instances"] = [{"group": "cloud", "translate": [1, 0, 0]}]
    with pytest.raises(InputError) as caught:
        compile_scene(check_document(document), blobs)
    [problem] = caught.value.problems
    assert problem.place == "$.groups.cloud[0].shape"
    assert "move the box away from its grid" in problem.message


def test_without_the_program_it_is_said(
    document: Document, blobs: BlobStore, program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program.unlink()
    monkeypatch.setattr("nocturne_scene.programs._BUILT", program.parent)
    monkeypatch.setenv("PATH", str(program.parent))
    document = smoke(document, blobs)
    with pytest.raises(InputError, match="nocturne-grid is missing on this machine"):
        compile_scene(check_document(document), blobs)
