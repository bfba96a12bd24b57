"""Glare ratings compared with published ones: a room worked out by hand in CIE 190, and evalglare's
ratings."""

import math

import numpy as np
import pytest
from nocturne_scene.photometry.directions import directions_of
from nocturne_scene.photometry.glare import View, glare_of
from nocturne_scene.quantities import LUMINANCE

from tests.scene.eyes import Values, image_of, with_sources

# CIE 190:2010 works out the table of unified glare ratings of one luminaire, as transcribed in
# github.com/123VincentB/eulumdat-ugr (data/input/sample_11.ldt, data/reference/ugr_table_11_cie190.csv,
# background.py). Its opening is 1 m x 0.316 m; its luminous intensity in cd for 1000 lm, of which rows are
# the planes C = 0, 15, ... 90 degrees and columns gamma = 30, 35, ... 80 degrees from the nadir, is:
_INTENSITY = np.array(
    [
        [193, 178, 158, 136, 114, 92, 72, 54, 44, 27, 22],
        [194, 179, 160, 135, 115, 94, 73, 55, 44, 29, 21],
        [197, 181, 162, 140, 118, 99, 77, 59, 43, 34, 20],
        [208, 182, 167, 145, 123, 105, 86, 65, 47, 33, 18],
        [222, 194, 171, 153, 130, 111, 92, 75, 55, 36, 21],
        [231, 214, 189, 163, 143, 119, 99, 79, 61, 44, 25],
        [232, 217, 204, 184, 152, 125, 101, 79, 60, 43, 25],
    ]
)
_LENGTH, _WIDTH, _ABOVE_EYE = 1.0, 0.316, 2.0

# Its worked room is 2 H wide and 4 H long, H = 2 m above the eye, with eight luminaires 2 m apart. Of their
# flux, 0.390 falls on the floor and 0.260 on the walls. By reflectances of ceiling, walls and floor: what of
# both returns to the eye's plane, and the ratings across and along the luminaires.
_FLOOR, _WALLS, _AREA_OF_WALLS = 0.390, 0.260, 48.0
_RATINGS = {
    "70/50/20": (0.187, 0.351, 11.0, 13.1),
    "30/30/20": (0.132, 0.151, 13.0, 15.2),
}


def intensity(plane: float, gamma: float) -> float:
    """Between the table's angles, in degrees, as straight lines."""
    row, column = plane / 15, (gamma - 30) / 5
    i, j = min(int(row), 5), int(column)
    u, v = row - i, column - j
    corners = np.outer([1 - u, u], [1 - v, v]) * _INTENSITY[i : i + 2, j : j + 2]
    return float(corners.sum())


def room(background: float, along: bool) -> Values:
    """What an eye in the middle of the short wall sees all around."""
    right, up, forward = np.moveaxis(directions_of("panorama", 1024, 512).direction, -1, 0)
    seen = (up > 0) & (forward > 0)
    to_ceiling = _ABOVE_EYE / np.maximum(up, 1e-9)
    x, y = right * to_ceiling, forward * to_ceiling
    across, away = (_WIDTH, _LENGTH) if along else (_LENGTH, _WIDTH)
    luminance = np.full(up.shape, background)
    for beside in (-1.0, 1.0):
        # The nearest pair at 1 m is too steep for the table of position indices, and CIE 117 leaves it out.
        for ahead in (3.0, 5.0, 7.0):
            gamma = math.degrees(math.atan(math.hypot(beside, ahead) / _ABOVE_EYE))
            plane = math.degrees(math.atan(abs(beside) / ahead))
            projected = _LENGTH * _WIDTH * math.cos(math.radians(gamma))
            lit = seen & (np.abs(x - beside) < across / 2) & (np.abs(y - ahead) < away / 2)
            luminance[lit] = intensity(90 - plane if along else plane, gamma) / projected
    return luminance


@pytest.mark.parametrize("along", [False, True])
@pytest.mark.parametrize("reflectances", _RATINGS)
def test_a_room_has_the_rating_that_cie_190_works_out(reflectances: str, along: bool) -> None:
    of_floor, of_walls, *published = _RATINGS[reflectances]
    flux = 8 * 1000.0
    background = flux / _AREA_OF_WALLS * (_FLOOR * of_floor + _WALLS * of_walls) / math.pi
    found = glare_of(image_of(room(background, along)), LUMINANCE, "panorama", View(threshold=30.0))
    assert len(found.sources) == 6
    # Published to one digit, with Guth's table in place of the formula: 12 % of one index is a unit here.
    assert found.ugr == pytest.approx(published[along], abs=0.25)


# What evalglare 3.06 (2025-10-01) says with -b 2000 -x of an equidistant fisheye of 180 degrees, 800 x 800
# pixels: discs as azimuth, elevation and half angle in degrees and cd/m2, with evalglare's position index;
# the background in cd/m2; its E_v, DGP and UGR.
_EVALGLARE = [
    (
        [((0.0, 30.0, 4.0, 20_000.0), 3.3196), ((25.0, 15.0, 4.0, 20_000.0), 2.0178)],
        400.0,
        (1781.9, 0.30345, 24.885),
    ),
    (
        [
            ((-20.0, 25.0, 8.0, 12_000.0), 2.7403),
            ((35.0, -10.0, 5.0, 8_000.0), 1.6776),
            ((5.0, -30.0, 6.0, 5_000.0), 1.5860),
            ((-50.0, 40.0, 10.0, 9_000.0), 9.8520),
        ],
        600.0,
        (3150.6, 0.36314, 23.767),
    ),
]


@pytest.mark.parametrize(("sources", "background", "said"), _EVALGLARE)
def test_ratings_are_those_of_evalglare(
    sources: list[tuple[tuple[float, float, float, float], float]],
    background: float,
    said: tuple[float, float, float],
) -> None:
    y = with_sources("equidistant", [disc for disc, _ in sources], background, (800, 800))
    found = glare_of(image_of(y), LUMINANCE, "equidistant", View())
    illuminance, dgp, ugr = said
    assert found.vertical_illuminance == pytest.approx(illuminance, rel=0.005)
    assert found.dgp == pytest.approx(dgp, abs=0.001)
    assert found.ugr == pytest.approx(ugr, abs=0.15)
    assert len(found.sources) == len(sources)
    for (azimuth, elevation, _, luminance), index in sources:
        (source,) = [each for each in found.sources if abs(each.azimuth_degrees - azimuth) < 1.0]
        assert source.luminance == pytest.approx(luminance, rel=1e-9)
        assert source.elevation_degrees == pytest.approx(elevation, abs=0.1)
        # Below the line of sight it has a smooth curve since its version 3, where Iwata's steps by 13 %.
        assert source.position_index == pytest.approx(index, rel=0.02 if elevation > 0 else 0.13)
