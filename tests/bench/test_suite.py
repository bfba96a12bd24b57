"""The arithmetic of the suite of error against time, and its pages. No renders."""

import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.chart import Line, write_chart

from bench.accumulation import _sums
from bench.coverage_chart import coverage_chart
from bench.error_bars import SCENES as NAMES
from bench.error_bars import SEQUENCES, diagnosis
from bench.peer.agreement import Reference
from bench.plain import _same
from bench.programs import Traced
from bench.scenes import Document
from bench.suite import page, references
from bench.suite.aims import AIMS, WHY, best
from bench.suite.measure import TARGET, _errors, time_to_target
from bench.suite.scenes import SCENES
from bench.ways import WAYS


def test_charts_of_many_decades_have_labels_that_do_not_touch(tmp_path: Path) -> None:
    path = tmp_path / "chart.svg"
    write_chart(path, "t", "x", "y", [Line("a", [(1e-3, 1e-18), (1e9, 5.0)])])
    labels = re.findall(r'<text x="([\d.]+)" y="([\d.]+)" text-anchor="(middle|end)"', path.read_text())
    heights = [float(y) for _, y, anchor in labels if anchor == "end"]
    places = [float(x) for x, y, anchor in labels if anchor == "middle" and float(y) < 380]
    assert len(heights) > 4
    assert len(places) > 4
    assert all(abs(after - before) >= 14 for before, after in pairwise(heights))
    assert all(after - before >= 44 for before, after in pairwise(places))


def test_the_summary_is_that_of_the_kept_figures() -> None:
    """`python -m bench.suite --pages` writes it; the service's page shows it."""
    folder = Path(page.__file__).parents[1] / "results"
    figures = json.loads((folder / "suite.json").read_text())
    assert json.loads((folder / page.SUMMARY).read_text()) == page.summary_of(figures)


def _points(exponent: float) -> list[dict[str, Any]]:
    """relMSE 0.01 after a second."""
    return [
        {
            "budget_cpu_s": t,
            "cpu_s": t,
            "relmse": 0.01 * t**exponent,
            "trimmed": 0.005,
            "z": 0.5,
            "not_finite": 0.0,
        }
        for t in (0.5, 1.0, 2.0, 4.0)
    ]


def test_time_to_one_percent() -> None:
    """Independent samples: error times time is constant."""
    found = time_to_target(_points(-1.0))
    assert found == {
        "seconds_to_1_percent": pytest.approx(0.01 / TARGET),
        "exponent": -1.0,
        "error": pytest.approx(0.0025),
    }
    assert time_to_target([{"cpu_s": 1.0, "relmse": -1e-9}]) == {}


def test_no_time_is_told_of_what_does_not_converge() -> None:
    """A method that finds no light keeps the same error at all times, so it has no time to 1 %."""
    assert time_to_target(_points(0.0)) == {"exponent": 0.0, "error": pytest.approx(0.01)}


def test_errors_of_an_image() -> None:
    """A reference that is exact, an image that is off by 10 % in one pixel of a hundred."""
    truth = np.ones((10, 10))
    image = truth.copy()
    image[3, 4] = 1.1
    found = _errors(image, Reference(truth, np.zeros_like(truth)))
    assert found["relmse"] == pytest.approx(0.01 / 1.01 / 100)
    assert found["trimmed"] == 0.0
    # One outlier is one standard error, whatever its size.
    assert found["z"] == pytest.approx(1.0, rel=0.01)


def test_pixels_that_are_no_numbers_are_counted() -> None:
    truth = np.ones((10, 10))
    image = truth.copy()
    image[3, 4], image[5, 5] = np.nan, np.inf
    found = _errors(image, Reference(truth, np.full_like(truth, 0.01)))
    assert found["not_finite"] == pytest.approx(0.02)
    assert np.isfinite(found["relmse"])


def test_a_bias_everywhere_is_seen() -> None:
    random = np.random.default_rng(1)
    truth = np.ones((16, 16))
    image = truth * 1.1 + random.normal(0.0, 0.1, truth.shape)
    assert _errors(image, Reference(truth, np.zeros_like(truth)))["z"] > 10.0


def test_a_reference_of_another_scene_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(references, "results_folder", lambda: tmp_path)
    document: Document = {"nocturne": 1, "sensor": {}}
    with pytest.raises(NocturneClientError, match="there is no reference of cornell"):
        references.load("cornell", document)
    told = {"tracing": {"seed": 3}, "important_directions": [], "note": "b"}
    assert references.digest(document) == references.digest({**document, **told})
    assert references.digest(document) != references.digest({**document, "surfaces": []})


@pytest.mark.parametrize("name", [name for name in SCENES if name != "smoke"])
def test_kept_references_are_of_the_scenes(name: str, tmp_path: Path) -> None:
    """Smoke is left out: to simulate it takes half a minute."""
    scene = SCENES[name]
    stored = references.load(name, scene.document(tmp_path))
    assert stored.reference.y.shape == (scene.film.height, scene.film.width)
    assert (stored.reference.error > 0.0).any()


def _way(exponent: float, factor: float = 1.0, z: float = 0.5) -> dict[str, Any]:
    points = [{**point, "relmse": factor * point["relmse"], "z": z} for point in _points(exponent)]
    return {"points": points, **time_to_target(points)}


def _figures(ways: dict[str, Any]) -> dict[str, Any]:
    scene = {
        "machine": "a machine",
        "load_average": [1.0, 2.0],
        "budgets_cpu_s": [0.5, 1.0, 2.0, 4.0],
        "rounds": 1,
        "ways": ways,
        "not there": {"Mitsuba y": "no discs"},
    }
    return {"cornell": scene}


def test_page_compares_with_the_best() -> None:
    ways = {
        "two photons": _way(-1.0),
        "split": _way(-1.0, 2.0),
        "path": _way(0.0),
        "Mitsuba x": _way(-1.0, 4.0),
        "march": {"points": []},
    }
    text = page.details(_figures(ways))
    assert "| two photons | 100 | 1 | -1 | 0.0025 |" in text
    assert "| split | 200 | 2 | -1 | 0.005 |" in text
    assert "| path | does not converge | | 0 | 0.01 |" in text
    assert "| march | too slow" in text
    assert "| cornell | 0.25 (two photons) | 0.25 | 0.009 | at most 1 | held |" in text
    assert "| sky | | | | at most 1 | not measured |" in text
    assert "Mitsuba y is not there: no discs." in text


def test_times_shorter_than_any_measured_are_equal() -> None:
    """A line through images that are as good as exact says nothing of how long 1 % takes."""
    ways = {"two photons": _way(-1.0, 1e-6), "kernel only": _way(-1.0, 1e-3)}
    text = page.details(_figures(ways))
    assert "| two photons | less than 0.5 | 1 |" in text
    assert "| kernel only | less than 0.5 | 1 |" in text


def test_page_says_what_is_missed_and_by_how_much() -> None:
    text = page.details(_figures({"two photons": _way(-1.0), "Mitsuba x": _way(-1.0, 0.5)}))
    assert "| cornell | 2 (two photons) | 2 | 0.07 | at most 1 | **missed by 2** |" in text
    assert f"- **cornell**: {WHY['cornell']}" in text


def test_page_says_when_the_reference_cant_tell() -> None:
    text = page.details(_figures({"two photons": _way(-1.0), "Mitsuba x": _way(-1.0, 1e-3)}))
    row = next(line for line in text.splitlines() if line.startswith("| cornell | 1e+03"))
    assert "not comparable" in row
    assert "missed" not in row


def test_a_screen_shows_the_default_and_mitsuba() -> None:
    ways = {
        "auto": _way(-1.0),
        "split": _way(-1.0, 2.0),
        "Mitsuba x": _way(-1.0, 4.0),
        "Mitsuba y": _way(0.0),
    }
    text = page.speed(_figures(ways))
    assert "| cornell | 100 | 100 (auto) | 400 (x) |" in text
    assert "- **cornell**" not in text
    text = page.speed(_figures({"auto": _way(-1.0), "Mitsuba y": _way(0.0)}))
    assert "| cornell | 100 | 100 | does not converge |" in text
    text = page.speed(_figures({"auto": _way(-1.0)}))
    assert "| cornell | 100 | 100 | can't render it |" in text
    assert f"- **cornell**: {WHY['cornell']}" in text


def test_finding_no_light_is_not_the_best_way() -> None:
    """A black image has a relMSE below 1, and a mean that is far off."""
    ways = {"two photons": _way(-1.0), "kernel only": _way(0.0, 0.1, z=-9.0), "path": _way(-1.0, 0.1)}
    assert best(ways, peers=False) == "two photons"
    assert best(ways, peers=True) is None


def test_all_aims_have_reasons() -> None:
    assert list(AIMS) == list(SCENES) == list(WHY)


def test_charts_show_all_lines_and_no_label_on_another(tmp_path: Path) -> None:
    lines = [Line(f"way {number}", [(1.0, 1.0), (2.0, 0.5 + 0.001 * number)]) for number in range(15)]
    write_chart(tmp_path / "chart.svg", "title", "x", "y", lines)
    found = re.findall(r'y="([0-9.]+)"[^>]*>(way [0-9]+)<', (tmp_path / "chart.svg").read_text())
    labels = {name: float(height) for height, name in found}
    assert len(labels) == 15
    heights = sorted(labels.values())
    assert all(after - before >= 13.9 for before, after in pairwise(heights))
    with pytest.raises(ValueError, match="at most 21"):
        write_chart(tmp_path / "chart.svg", "title", "x", "y", lines * 2)


def test_ways_have_different_names() -> None:
    assert len({way.name for way in WAYS}) == len(WAYS)


def test_sums_stand_still_in_single_precision_only() -> None:
    """Exponential samples in 32-bit floats: -1.1 % at 1e7, a known figure; the double-precision sum is exact
    compared with the noise."""
    last = _sums(10**7)[-1]
    assert last["float32"] == pytest.approx(0.011, abs=0.002)
    assert last["ours"] < 1e-12 < 0.1 * last["noise"]


def test_diagnosis_counts_renders() -> None:
    figures: dict[str, Any] = {"renders": 10}
    for name in NAMES:
        for sequence in SEQUENCES:
            broken = name == NAMES[0]
            figures[f"{name}, {sequence}"] = {
                "coverage": {"95 %": 0.5 if broken else 0.95},
                "flagged": 0.8 if broken else 0.1,
            }
    sound = 2 * (len(NAMES) - 1)
    count = diagnosis(figures)
    assert count == {"hits": 16, "misses": 4, "false alarms": sound, "sound": 9 * sound}


def test_plain_tracer_must_give_the_same_image() -> None:
    image = np.ones((2, 2, 3))
    full = Traced(image, image[..., 1], image[..., 1], 7, 21, 1.0, 1.0, 1.0)
    _same(full, replace(full, tracing_cpu_s=2.0))
    with pytest.raises(NocturneClientError, match="another image"):
        _same(full, replace(full, xyz=1.0000001 * image))


def test_the_chart_of_coverage_has_a_dot_for_each_reading() -> None:
    """At the heights of what was observed: 80 % lies midway between 60 and 100 %."""
    figures = {"cornell, sobol": {"coverage": {"68 %": 0.8, "95 %": 1.0, "99 %": 0.6}}}
    dots = re.findall(r'cy="([0-9.]+)" r="4" fill="[^"]+">\s*<title>([^<]+)', coverage_chart(figures))
    heights = {told: float(y) for y, told in dots}
    assert set(heights) == {f"cornell, sobol: {each} %" for each in ("80", "100", "60")}
    middle = (heights["cornell, sobol: 100 %"] + heights["cornell, sobol: 60 %"]) / 2
    assert heights["cornell, sobol: 80 %"] == pytest.approx(middle)
