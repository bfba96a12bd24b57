"""`nocturne report`: its files, its plan, and what it refuses."""

import json
import math
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.programs import CHECKOUT
from nocturne_client.local.report.plan_lines import Frame, clipped, plan_lines
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.writing.compiled import Compiled
from nocturne_scene.photometry.places import Part
from typer.testing import CliRunner

OFFICE = CHECKOUT / "examples" / "office"


def _run(*words: str | Path) -> str:
    result = CliRunner().invoke(app, [*map(str, words)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture(scope="module")
def evening(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An image of the example's meters, with few samples."""
    image = tmp_path_factory.mktemp("office") / "evening.exr"
    _run("render", OFFICE / "scene.json", "-o", image, "--samples", "256", "--threads", "2")
    return image


def test_an_office_from_its_image_to_a_report(evening: Path, tmp_path: Path) -> None:
    files = [tmp_path / f"report.{ending}" for ending in ("pdf", "html", "svg", "png")]
    outputs = [word for file in files for word in ("-o", str(file))]
    required = "--require", "EN 12464-1:34.2"
    said = _run("report", evening, "--scene", OFFICE / "scene.json", *required, *outputs)
    assert "Not measured: UGR" in said.replace("\n", " ")
    pdf, html, svg, png = (file.read_bytes() for file in files)
    assert pdf.startswith(b"%PDF-1.4")
    assert len(re.findall(rb"/Type /Page\b", pdf)) >= 2
    assert png.startswith(b"\x89PNG")
    names = {element.tag.rpartition("}")[2] for element in ElementTree.fromstring(svg).iter()}  # noqa: S314
    assert {"polygon", "polyline", "text"} <= names
    page = html.decode()
    # It stands alone.
    assert not re.search(r"(?:src|href)=|@import|url\(", page)
    assert "<svg" in page
    assert "@media print" in page
    for told in ("Em, working plane", "OFFICE-600", "maintenance factor", "0.450", "engine", "SHA-256"):
        assert told in page


def test_readings_are_those_of_measure(evening: Path, tmp_path: Path) -> None:
    """The mean and half of its interval, by both commands."""
    measured = json.loads(_run("measure", evening, "--json"))["measurements"][0]
    _run("report", evening, "-o", tmp_path / "report.html")
    found = re.search(r"<td class=number>([\d.]+) ± ([\d.]+)</td>", (tmp_path / "report.html").read_text())
    assert found is not None
    half = 1.96 * measured["mean_error"]
    assert float(found[1]) == pytest.approx(measured["mean"], abs=0.06 * half)
    assert float(found[2]) == pytest.approx(half, rel=0.06)


def test_a_render_of_the_service(evening: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its image and its document are fetched; a document that names files is left out, and that is said."""

    class Service:
        def __init__(self, url: str | None) -> None:
            assert url == "http://there"

        def __enter__(self) -> "Service":
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def download(self, render: str, kind: str, path: Path) -> Path:
            assert render == "r-1"
            document = json.loads((OFFICE / "scene.json").read_text())
            if "groups" in document and not self.files:
                del document["groups"], document["instances"]
                document["environment"] = {"radiance": 1.0}
            path.write_bytes(evening.read_bytes() if kind == "exr" else json.dumps(document).encode())
            return path

        files = False

    monkeypatch.setattr("nocturne_client.cli.report_command.Client", Service)
    words = "report", "r-1", "--url", "http://there", "-o", tmp_path / "report.html"
    _run(*words)
    page = (tmp_path / "report.html").read_text()
    assert "<h2>Materials</h2>" in page
    assert "r-1; 256 samples a meter" in page
    monkeypatch.setattr(Service, "files", True)
    _run(*words)
    page = (tmp_path / "report.html").read_text()
    assert "<h2>Materials</h2>" not in page
    assert "No scene document was given" in page


def test_equal_images_give_equal_reports(evening: Path, tmp_path: Path) -> None:
    for name in ("one.svg", "other.svg"):
        _run("report", evening, "--scene", OFFICE / "scene.json", "-o", tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "other.svg").read_bytes()


def test_a_limit_at_the_value_itself_is_open(evening: Path, tmp_path: Path) -> None:
    measured = json.loads(_run("measure", evening, "--json"))["measurements"][0]
    said = _run("report", evening, "--require", f"Em={measured['mean']:.3f}", "-o", tmp_path / "a.html")
    assert "open" in said
    assert "50 % that it holds" in (tmp_path / "a.html").read_text()


def test_a_year_in_a_report(evening: Path, tmp_path: Path) -> None:
    """Heat map, histogram, table, and a verdict by the points' probabilities: with ten points that pass with
    90 % each, nine or more do with 0.9^10 + 10 x 0.9^9 x 0.1 = 0.736."""
    share = {"value": 0.9, "low": 0.7, "high": 1.0}
    days = [[0.0] * 8 + [400.0] * 8 + [0.0] * 8] * 365
    figure = {"value": 0.5, "low": 0.4, "high": 0.6}
    annual = {
        "weather": "Here",
        "hours": 3650,
        "sDA": share | {"probabilities": [0.9] * 10},
        "ASE": share,
        "verdicts": [],
        "hourly": [each for day in days for each in day],
        "means": {"DA": figure},
        "points": [{"DA": {"value": 0.05 + 0.1 * i}} for i in range(10)],
    }
    year, page = tmp_path / "year.json", tmp_path / "report.html"
    year.write_text(json.dumps(annual))
    said = _run("report", evening, "--annual", year, "--require", "sDA=90", "-o", page)
    assert "open" in said
    html = page.read_text()
    assert "open, 74 % that it holds" in html
    assert "mean illuminance by day and hour" in html
    drawn = re.search(r"<svg[^>]*><title>mean illuminance by day.*?</svg>", html)
    assert drawn is not None
    # A row of light for each of the eight hours, one of night for each other, and the legend's ten.
    assert drawn[0].count("<polygon") == 24 + 10
    assert "points by their daylight autonomy" in html


def test_what_is_refused(evening: Path, tmp_path: Path) -> None:
    out = tmp_path / "report.html"
    for words, told in (
        (["-o", "report.docx"], r"ends in \.pdf, \.html, \.json, \.svg or \.png"),
        (["-o", out, "--require", "lux=5"], "--require"),
        (["-o", out, "--task", "ceiling"], "expected one of working plane, faces"),
        (["-o", out, "--annual", OFFICE / "scene.json"], "expected a file of nocturne annual"),
    ):
        with pytest.raises(NocturneClientError, match=told):
            _run("report", evening, *words)


def _lines(surfaces: list[dict[str, Any]], tmp_path: Path) -> Any:
    document = check_document(
        {
            "nocturne": 1,
            "sensor": {
                "type": "irradiance_meter",
                "position": [2, 0.8, 1.5],
                "normal": [0, 1, 0],
                "up": [0, 0, -1],
                "height": 3,
            },
            "environment": {"radiance": 1},
            "surfaces": [{"kernel": {"type": "lambertian", "reflectance": 0.5}, **each} for each in surfaces],
        }
    )
    blobs = BlobStore(tmp_path, durable=False)
    output = compile_scene(document, blobs)
    message = scene_pb2.CompiledScene.FromString(blobs.path(output.scene_sha256).read_bytes())
    part = Part("", "plane", 0, 0, 4, 3, (0.5, 0.8, 0.5), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    return plan_lines(Compiled(message, blobs, document, Findings()), Frame.of(part), np.zeros(3))


def test_outlines_of_a_room_and_its_table(tmp_path: Path) -> None:
    """A plan of 4 m by 3 m at a height of 0.8 m: walls are cut, a table below is seen, a lamp is above."""
    wall = {"type": "box", "minimum": [-0.2, 0, -0.2], "maximum": [0, 3, 3.2]}
    table = {"type": "box", "minimum": [1, 0.6, 1], "maximum": [3, 0.7, 2]}
    shelf = {"type": "box", "minimum": [1, 1.6, 0], "maximum": [3, 1.7, 0.3]}
    lamp = {"type": "quad", "corner": [1.5, 2.9, 1.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 0.5]}
    luminaire = {"radiance": 1.0, "lumens": 1000}
    found = _lines(
        [{"shape": wall}, {"shape": table}, {"shape": shelf}, {"shape": lamp, "luminaire": luminaire}],
        tmp_path,
    )
    # x to the right, y up from z = 3.
    assert _corners(found.cut) >= {(-0.2, -0.2), (0.0, -0.2), (0.0, 3.2), (-0.2, 3.2)}
    assert _corners(found.lamps) == {(1.5, 1.5), (2.5, 1.5), (2.5, 1.0), (1.5, 1.0)}
    below = {corner for corner in _corners(found.below) if corner[0] > 0.5}
    assert below == {(1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (1.0, 2.0)}
    assert sum(math.dist(each[:2], each[2:]) for each in found.lamps) == pytest.approx(3.0)


def test_a_sphere_is_cut_in_a_circle(tmp_path: Path) -> None:
    """Of 0.5 m, with its middle 0.3 m below the plane: a circle of 0.4 m."""
    found = _lines([{"shape": {"type": "sphere", "centre": [2, 0.5, 1.5], "radius": 0.5}}], tmp_path)
    away = [math.dist((x, y), (2.0, 1.5)) for x, y in _corners(found.cut)]
    assert away
    assert np.allclose(away, 0.4, atol=2e-4)


def _corners(segments: set[tuple[float, float, float, float]]) -> set[tuple[float, float]]:
    return {(round(x, 4) + 0.0, round(y, 4) + 0.0) for each in segments for x, y in (each[:2], each[2:])}


def test_lines_end_at_the_edge_of_the_plan() -> None:
    box = (0.0, 0.0, 2.0, 1.0)
    assert list(clipped([(-1.0, 0.5, 3.0, 0.5)], box)) == [(0.0, 0.5, 2.0, 0.5)]
    assert list(clipped([(-1.0, -1.0, -1.0, 3.0)], box)) == []
    assert list(clipped([(0.5, 0.5, 1.0, 0.75)], box)) == [(0.5, 0.5, 1.0, 0.75)]
