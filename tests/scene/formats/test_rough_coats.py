"""What Mitsuba's rough coat lets through, against Mitsuba itself and against another quadrature."""

import numpy as np
import pytest
from nocturne_scene.formats.reading.coats import rough_coat, smooth_coat
from nocturne_scene.formats.reading.fresnel import reflectance_of
from nocturne_scene.formats.reading.rough_coats import Facets, unit_interval

INDEX = 1.5
BASE = 0.2

# The diffuse part of Mitsuba 3.9.1's own roughplastic, indices 1.5 and 1, reflectance 0.2, without the
# cosine: distribution, alpha, nonlinear; values at the cosines (1, 1), (0.5, 0.5) and (0.2, 0.8).
PUBLISHED = [
    ("ggx", 0.1, False, [0.058138, 0.051886, 0.043075]),
    ("ggx", 0.4, False, [0.038967, 0.032621, 0.029947]),
    ("ggx", 1.0, False, [0.024872, 0.013607, 0.011514]),
    ("beckmann", 0.1, False, [0.062228, 0.055797, 0.043840]),
    ("beckmann", 0.4, True, [0.028861, 0.025464, 0.024360]),
    ("beckmann", 1.0, False, [0.033146, 0.027673, 0.025146]),
]


@pytest.mark.parametrize(("distribution", "alpha", "nonlinear", "values"), PUBLISHED)
def test_the_model_is_mitsubas(distribution: str, alpha: float, nonlinear: bool, values: list[float]) -> None:
    """To 1e-3: Mitsuba interpolates its table of 64 cosines."""
    cosines = np.array([[1.0, 1.0], [0.5, 0.5], [0.2, 0.8]])
    _, _, through = Facets(alpha, distribution).means(cosines.ravel(), INDEX)
    theirs = rough_coat(INDEX, alpha, distribution).theirs
    lost = BASE * theirs if nonlinear else theirs
    found = through.reshape(3, 2).prod(axis=1) * BASE / (np.pi * INDEX**2 * (1 - lost))
    assert found == pytest.approx(np.array(values), rel=1e-3)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [0.15, 0.6, 0.95])
def test_means_over_facets_agree_with_sums_over_angles(
    distribution: str, alpha: float, cosine: float
) -> None:
    """Walter et al., eq. 25 and 33, by midpoints of the normal's angles."""
    angle = (np.arange(2000) + 0.5) / 2000 * np.pi / 2
    turn = (np.arange(200) + 0.5) / 200 * np.pi
    down, slope = np.cos(angle)[:, None], np.tan(angle)[:, None]
    density = (
        alpha**2 / (np.pi * down**4 * (alpha**2 + slope**2) ** 2)
        if distribution == "ggx"
        else np.exp(-((slope / alpha) ** 2)) / (np.pi * alpha**2 * down**4)
    )
    facing = cosine * down + np.sqrt(1 - cosine**2) * np.sin(angle)[:, None] * np.cos(turn)
    seen = density * np.sin(angle)[:, None] * np.maximum(facing, 0.0)
    expected = np.sum(seen * reflectance_of(np.clip(facing, 1e-9, 1.0), INDEX)) / seen.sum()
    share, _, _ = Facets(alpha, distribution).means(np.array([cosine]), INDEX)
    assert share[0] == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
def test_without_roughness_nothing_is_lost(distribution: str) -> None:
    cosines = np.array([0.2, 0.5, 1.0])
    share, back, through = Facets(1e-3, distribution).means(cosines, INDEX)
    assert back == pytest.approx(reflectance_of(cosines, INDEX), rel=2e-3)
    assert through == pytest.approx(1 - back, abs=1e-3)
    assert share == pytest.approx(back, rel=1e-3)
    assert rough_coat(INDEX, 1e-3, distribution).passing == pytest.approx(1.0, abs=1e-3)
    assert rough_coat(INDEX, 1e-3, distribution).inside == pytest.approx(smooth_coat(INDEX).inside, abs=1e-3)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_the_base_gives_mitsubas_albedo_in_even_light(nonlinear: bool) -> None:
    """Of the diffuse part: both kernels integrated over all directions, from all sides."""
    alpha = 0.7
    nodes, weights = unit_interval(100)
    weights = 2 * nodes * weights
    coat = rough_coat(INDEX, alpha, "beckmann")
    _, _, through = Facets(alpha, "beckmann").means(nodes, INDEX)
    lost = BASE * coat.theirs if nonlinear else coat.theirs
    theirs = (weights @ through) ** 2 * BASE / (INDEX**2 * (1 - lost))
    base = coat.changed(np.array(BASE), linear=not nonlinear)
    share, _, _ = Facets(alpha, "ggx").means(nodes, INDEX)
    ours = (weights @ (1 - share)) ** 2 * base / (INDEX**2 * (1 - base * coat.inside))
    assert ours == pytest.approx(theirs, rel=1e-9)


def test_no_base_reflects_more_than_all() -> None:
    assert rough_coat(INDEX, 0.1, "ggx").changed(np.array(1.0), linear=True) <= 1.0
