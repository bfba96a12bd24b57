"""`nocturne annual`: its outputs and its refusals."""

import csv
import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from typer.testing import CliRunner

from tests.accuracy.test_daylight_coefficients import room
from tests.weather import epw

_FEW = ["--patches", "145", "--sun-patches", "145", "--samples", "1024", "--threads", "2", "--seed", "1"]


def _scene(folder: Path, **changes: Any) -> Path:
    document = room(0.5, [])
    grid = {"corner": [0, 0.8, 4], "right": [4, 0, 0], "up": [0, 0, -4], "columns": 2, "rows": 2}
    document["sensor"]["instruments"] = [
        {"name": "plane", "grid": grid},
        {"name": "roof", "points": [[2, 10, 2]], "normal": [0, 1, 0]},
    ]
    document["sensor"]["outdoor"] = "roof"
    lamp = {"type": "quad", "corner": [1, 2.9, 1], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}
    document["surfaces"].append(
        {
            "shape": lamp,
            "kernel": {"type": "lambertian", "reflectance": 0.5},
            "luminaire": {"radiance": 1.0, "lumens": 1e5},
        }
    )
    scene = folder / "room.json"
    scene.write_text(json.dumps(document | changes))
    (folder / "year.epw").write_text(epw())
    return scene


def _run(*words: str | Path) -> str:
    result = CliRunner().invoke(app, ["annual", *map(str, words)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_a_year_of_a_room(tmp_path: Path) -> None:
    """Four points, at the window and behind; the lamp does not count, nor does the meter on the roof."""
    scene = _scene(tmp_path)
    files = {name: tmp_path / name for name in ("year.json", "year.svg", "points.csv", "hours.csv")}
    outputs: list[str | Path] = [
        "-o",
        files["year.json"],
        "-o",
        files["year.svg"],
        "--table",
        files["points.csv"],
    ]
    outputs += ["--hours-table", files["hours.csv"]]
    said = _run(scene, "--weather", tmp_path / "year.epw", *_FEW, *outputs)
    assert "Testing, NOW: 3650 hours, 4 points, 95 % intervals" in said
    found = json.loads(files["year.json"].read_text())
    points = found["points"]
    assert [each["place"] for each in points] == [[1, 0.8, 1], [3, 0.8, 1], [1, 0.8, 3], [3, 0.8, 3]]
    autonomy = [each["DA"] for each in points]
    assert all(each["low"] <= each["value"] <= each["high"] for each in autonomy)
    assert min(autonomy[2]["value"], autonomy[3]["value"]) > max(autonomy[0]["value"], autonomy[1]["value"])
    parts = sum(value["value"] for name, value in found["means"].items() if name.startswith("UDI"))
    assert parts == pytest.approx(1)
    assert found["sDA"]["low"] <= found["sDA"]["value"] <= found["sDA"]["high"]
    assert [each["says"] for each in found["verdicts"]] == [
        "sDA >= 55%",
        "sDA >= 75%",
        "ASE <= 10%",
        "EN 17037 target: 300 lx over 50%",
        "EN 17037 minimum: 100 lx over 95%",
    ]
    target, least = (found[f"EN 17037 {name}"] for name in ("target", "minimum"))
    assert target["low"] <= target["value"] <= least["value"] <= least["high"]
    assert all(0 <= each["probability"] <= 1 for each in found["verdicts"])
    assert len(list(csv.reader(files["points.csv"].read_text().splitlines()))) == 5
    hours = list(csv.DictReader(files["hours.csv"].read_text().splitlines()))
    assert len(hours) == 8760
    # At midnight there is none, at noon more than in the morning.
    lux = [float(each["lux"]) for each in hours]
    assert lux[24 * 171] == 0 < lux[24 * 171 + 6] < lux[24 * 171 + 12]
    ElementTree.parse(files["year.svg"])  # noqa: S314 - our own


def test_a_year_with_blinds_eyes_and_melanopic_light(tmp_path: Path) -> None:
    """Blinds that let nothing pass, closed in the first half of the year: half of the light is gone. A grey
    room under D65 has as much melanopic EDI as illuminance."""
    scene = _scene(tmp_path)
    document = json.loads(scene.read_text())
    document["sensor"]["instruments"].append({"name": "eye", "points": [[2, 1.2, 2]], "normal": [0, 0, 1]})
    scene.write_text(json.dumps(document))
    blind = {"type": "quad", "corner": [-1, -1, 4.01], "edge_u": [6, 0, 0], "edge_v": [0, 6, 0]}
    document["surfaces"].append({"shape": blind, "kernel": {"type": "lambertian", "reflectance": 0.0}})
    closed = tmp_path / "closed.json"
    closed.write_text(json.dumps(document))
    schedule = tmp_path / "schedule.txt"
    schedule.write_text("1\n" * 4380 + "0\n" * 4380)
    out = tmp_path / "year.json"
    words: list[str | Path] = ["--weather", tmp_path / "year.epw", *_FEW, "--eye", "eye", "-o", out]
    said = _run(scene, *words, "--melanopic", "--blinds", closed, "--schedule", schedule)
    # Of hours with light: on winter's evenings there is none.
    found = re.search(r"blinds are closed in ([\d.]+)% of the hours", said)
    assert found is not None
    assert 43 < float(found[1]) < 50
    half = json.loads(out.read_text())
    assert len(half["points"]) == 5
    lux, melanopic = half["means"]["mean illuminance"], half["means"]["melanopic EDI"]
    assert melanopic["value"] == pytest.approx(lux["value"], rel=0.1)
    (eye,) = half["eyes"]
    assert (eye["instrument"], eye["place"]) == ("eye", [2, 1.2, 2])
    assert eye["DGPs above 0.45"]["value"] <= eye["DGPs above 0.35"]["value"] < 1
    _run(scene, *words)
    whole = json.loads(out.read_text())
    # The weather's halves are alike.
    assert lux["value"] / whole["means"]["mean illuminance"]["value"] == pytest.approx(0.5, abs=0.03)
    assert "blinds closed" not in whole
    # Blinds change nothing of the Sun's hours.
    assert half["ASE"] == whole["ASE"]


@pytest.mark.parametrize(
    ("changes", "words", "said"),
    [
        ({"sensor": {"type": "panorama", "position": [2, 1, 2], "look_at": [2, 1, 3]}}, [], "that of meters"),
        ({}, ["--patches", "100"], "expected 145, 577 or 2305"),
        ({}, ["--batches", "33"], "a multiple of 8"),
        ({}, ["--north", "0,1,0"], "north is straight up"),
        ({}, ["--north", "up"], "expected three numbers"),
        ({}, ["-o", "year.pdf"], "expected a name that ends in .json or .svg"),
        ({}, ["--hours", "23.2", "23.4"], "no hour of the day"),
        ({}, ["--schedule", "hours.txt"], "expected --blinds, too"),
    ],
)
def test_what_is_no_year_is_refused(
    tmp_path: Path, changes: dict[str, Any], words: list[str], said: str
) -> None:
    scene = _scene(tmp_path, **changes)
    with pytest.raises(NocturneClientError, match=said):
        _run(scene, "--weather", tmp_path / "year.epw", *words)


def test_errors_of_a_weather_file_say_where(tmp_path: Path) -> None:
    scene = _scene(tmp_path)
    weather = tmp_path / "year.epw"
    weather.write_text(weather.read_text().replace("LOCATION", "PLACE"))
    with pytest.raises(NocturneClientError, match=r"year\.epw, line 1: expected LOCATION"):
        _run(scene, "--weather", weather)
