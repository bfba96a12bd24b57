"""Closed forms of the suites against published digits, and what readings say together."""

import json
from random import Random

import pytest
from nocturne_scene.document.read import check_document
from nocturne_scene.validation import closed_forms as forms
from nocturne_scene.validation import films
from nocturne_scene.validation.cases import Value
from nocturne_scene.validation.skies import horizontal_illuminance, through_opening
from nocturne_scene.validation.suites import SUITES
from nocturne_scene.validation.truths import truths
from nocturne_scene.validation.verdict import Reading, verdict


def test_configuration_factors_have_the_catalogues_digits() -> None:
    """Howell's tables, and the two numbers that every textbook prints for a square above a point."""
    assert forms.coaxial_discs(1.0, 1.0, 1.0) == pytest.approx(0.38196601, rel=1e-7)
    assert forms.coaxial_discs(0.1, 0.1, 3.0) == pytest.approx(0.0011086488, rel=1e-7)
    assert forms.parallel_rectangles(1.0, 1.0, 1.0) == pytest.approx(0.1998249, rel=1e-6)
    assert forms.parallel_rectangles(1.0, 1.0, 10.0) == pytest.approx(0.0031620568, rel=1e-7)
    assert forms.perpendicular_rectangles(1.0, 1.0, 1.0) == pytest.approx(0.20004378, rel=1e-7)
    assert forms.perpendicular_rectangles(0.5, 3.0, 1.0) == pytest.approx(0.31960896, rel=1e-7)
    assert forms.sphere_to_disc(2.0, 1.0) == pytest.approx(0.052786405, rel=1e-7)
    corner = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
    assert forms.point_to_polygon([0, 0, 0], [0, 0, 1], corner) == pytest.approx(0.138532, abs=1e-6)
    assert forms.point_to_polygon([0.5, 0.5, 0], [0, 0, 1], corner) == pytest.approx(0.239456, abs=1e-6)
    assert forms.point_to_disc(1.0, 2.0, 1e-4) == pytest.approx(forms.point_to_disc(1.0, 2.0), rel=1e-6)


def test_plates_and_faces_have_the_published_digits() -> None:
    assert forms.fresnel(1.5, 60.0) == pytest.approx(0.089186713, rel=1e-7)
    assert forms.plate(1.52, 60.0) == pytest.approx((0.8306926, 0.1693074), rel=1e-6)
    assert forms.plate(1.8, 75.0, 0.05) == pytest.approx((0.51015587, 0.43365005), rel=1e-6)


def test_skies_have_the_closed_forms_of_the_overcast_sky() -> None:
    """7 pi / 9 for Moon and Spencer's, pi for an even one; and the printed daylight factors of CIE 171."""
    assert horizontal_illuminance(16) == pytest.approx(7.0 * 3.14159265 / 9.0, rel=1e-6)
    assert horizontal_illuminance(5) == pytest.approx(3.14159265, rel=1e-6)
    known = truths("cie171")["5.9"]["A to N"]["1"]
    edges = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    for kind in ("1", "12", "16"):
        found = through_opening(int(kind), [2.0, 1.75, 0.0], [0, 0, 1], [1.5, 1.5, 3.0], edges)
        assert 100.0 * found / horizontal_illuminance(int(kind)) == pytest.approx(known[kind][9], rel=3e-5)


def test_suites_name_every_value_once_and_its_source() -> None:
    names = []
    for suite in SUITES:
        for scene in suite.scenes():
            names += [(suite.name, value.name) for value in scene.values]
            assert all(value.source and value.truth > 0.0 for value in scene.values)
    assert len(set(names)) == len(names)
    assert len(names) >= 300


def _drawn(bias: float, wide: float, count: int = 400) -> list[Reading]:
    random = Random(5)
    value = Value("", 1.0, "drawn")
    return [
        Reading("", value, random.gauss(1.0 + 0.01 * bias, 0.01 * wide), 0.01, 0.0196) for _ in range(count)
    ]


def test_a_verdict_knows_a_bias_and_errors_that_are_too_small() -> None:
    """400 normal values: a bias of 0.3 standard errors is 6 of the mean's, errors too small by a fifth are 7
    of the deviation's."""
    assert verdict(_drawn(0.0, 1.0)).is_good
    assert not verdict(_drawn(0.3, 1.0)).is_good
    assert not verdict(_drawn(0.0, 1.25)).is_good
    found = verdict(_drawn(0.0, 1.0))
    assert found.inside == pytest.approx(0.95, abs=0.03)
    assert found.mean_bound == pytest.approx(2.5758 / 20.0, rel=1e-4)


def test_readings_without_noise_are_right_to_rounding_or_wrong() -> None:
    value = Value("", 2.0, "drawn")
    exact, wrong = Reading("", value, 2.00002, 0.0, 0.0), Reading("", value, 2.01, 0.0, 0.0)
    assert verdict([exact]).exact == 1
    assert verdict([exact]).is_good
    assert verdict([exact, wrong]).wrong == 1
    assert not verdict([exact, wrong]).is_good


def test_documents_of_films_are_valid() -> None:
    """Written from numbers that may be complex."""
    for scene in films.scenes():
        check_document(json.loads(json.dumps(scene.document)))
