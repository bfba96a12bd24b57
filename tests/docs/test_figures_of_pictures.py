"""Figures in pictures, or below them, are those of their renders; older engines are named."""

import json
from pathlib import Path

import numpy as np
import pytest
from nocturne.v1 import job_pb2

from examples.gallery import FIGURES, PAGE, adaptation, measured_error, pictures
from examples.hero import illuminance

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
IMAGES = ROOT / "docs" / "images"


def test_the_readme_has_the_label_and_the_error_of_its_first_picture() -> None:
    figures = json.loads((IMAGES / "hero.json").read_text(encoding="utf-8"))
    assert figures["label"] in README
    assert f"{100 * figures['measured_error']:.2g} %" in README


def test_pictures_of_older_engines_are_named() -> None:
    """A picture without an engine, or of one that does not exist, is a mistake; older ones are listed."""
    kept = json.loads(FIGURES.read_text(encoding="utf-8"))["pictures"]
    engines = {name: figures["engine"] for name, figures in kept.items()}
    assert all(1 <= each <= job_pb2.ENGINE_CURRENT for each in engines.values())
    page = PAGE.read_text(encoding="utf-8")
    newest = max(engines.values())
    older = sorted({each for each in engines.values() if each < newest})
    assert f"older engines ({', '.join(map(str, older))})" in page


def test_large_pictures_state_their_measured_error() -> None:
    kept = json.loads(FIGURES.read_text(encoding="utf-8"))["pictures"]
    for picture in pictures():
        if picture.is_large:
            assert picture.seeds >= 2
            assert f"Relative error {100 * kept[picture.scene]['measured_error']:.2g} %" in PAGE.read_text()


def test_the_measured_error_is_that_of_the_mean() -> None:
    """Two renders of deviation 0.2 around 1: their mean has 0.2 / sqrt 2, relative to sqrt(1 + 0.01)."""
    values = 1 + 0.2 * np.random.default_rng(1).standard_normal((2, 300, 300))
    assert measured_error(values) == pytest.approx(0.2 / np.sqrt(2) / np.sqrt(1.01), rel=0.05)


def test_adaptation_shows_the_light_as_white() -> None:
    x, y = 0.4053, 0.3907
    seen = adaptation((x, y)) @ np.array([x / y, 1, (1 - x - y) / y])
    assert seen == pytest.approx([0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290], rel=1e-9)
    # B. Lindbloom's matrix of Bradford from D50 to D65; its white points have five digits.
    published = [
        [0.9555766, -0.0230393, 0.0631636],
        [-0.0282895, 1.0099416, 0.0210077],
        [0.0122982, -0.0204830, 1.3299098],
    ]
    assert adaptation((0.34567, 0.35850)) == pytest.approx(np.array(published), abs=2e-3)


def test_illuminance_is_read_from_diffuse_surfaces_alone() -> None:
    """A white sheet of albedo 0.8 under 500 lx has 500 x 0.8 / pi cd/m2; lamps and the sky have none."""
    luminance = np.array([[500 * 0.8 / np.pi, 1000.0, 30.0]])
    lux, known = illuminance(luminance, np.array([[0.8, 0.8, 0.0]]), np.array([[0.0, 1.0, 0.0]]))
    assert lux[0, 0] == pytest.approx(500)
    assert known.tolist() == [[True, False, False]]
