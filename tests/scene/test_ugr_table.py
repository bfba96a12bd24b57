"""The tabular method of unified glare rating against the room that CIE 190:2010 works out."""

import math

import numpy as np
import pytest
from nocturne_scene.photometry.intensities import Photometry
from nocturne_scene.photometry.ugr_table import (
    REFLECTANCES,
    ROOMS,
    Room,
    Shares,
    rating,
    returns_to_walls,
    shares_of,
    table,
)

from tests.scene.test_glare_published import _FLOOR, _INTENSITY, _LENGTH, _RATINGS, _WALLS, _WIDTH

WORKED = Room(2.0, 4.0, 2.0, 1.0)
"""2 H x 4 H, H = 2 m, luminaires 2 m apart."""


def _luminaire() -> Photometry:
    """Planes from C = 0, across the luminaire, are horizontal angles from 90 degrees here; what is
    below gamma 30 does not count. The light is symmetric."""
    quarter = np.hstack([np.repeat(_INTENSITY[:, :1], 6, axis=1), _INTENSITY, np.zeros((7, 2))])
    vertical = np.arange(0.0, 95.0, 5.0)
    # Here 0 is along the length: C = 90.
    from_length = quarter[::-1]
    half = np.vstack([from_length, from_length[-2::-1]])
    whole = np.vstack([half, half[1:]])
    return Photometry(vertical, np.arange(0.0, 375.0, 15.0), whole, opening=(_WIDTH, _LENGTH, 0.0))


def test_factors_of_cie_190() -> None:
    for (ceiling, walls), name in (((0.7, 0.5), "70/50/20"), ((0.3, 0.3), "30/30/20")):
        found = returns_to_walls(WORKED, (ceiling, walls, 0.2))
        of_floor, of_walls, *_ = _RATINGS[name]
        assert found[2] == pytest.approx(of_floor, abs=6e-4)
        assert found[1] == pytest.approx(of_walls, abs=6e-4)


@pytest.mark.parametrize("name", _RATINGS)
def test_ratings_of_the_worked_room(name: str) -> None:
    """Published to one digit, by Guth's table of position indices; its formula is up to 12 % off that."""
    shares = Shares(0.0, 8000.0 * _WALLS, 8000.0 * _FLOOR)
    reflectances = (0.7, 0.5, 0.2) if name == "70/50/20" else (0.3, 0.3, 0.2)
    *_, crosswise, endwise = _RATINGS[name]
    luminaire = _luminaire()
    assert rating(luminaire, WORKED, "crosswise", shares, reflectances) == pytest.approx(crosswise, abs=0.25)
    assert rating(luminaire, WORKED, "endwise", shares, reflectances) == pytest.approx(endwise, abs=0.25)


def _even(candela: float = 100.0) -> Photometry:
    """The same in all directions below."""
    return Photometry(
        np.array([0.0, 90.0]), np.zeros(1), np.array([[candela, candela]]), opening=(0.3, 0.6, 0.0)
    )


def test_shares_of_an_even_luminaire() -> None:
    """Of one that shines evenly below, in the middle of a square, by the solid angle of the floor."""
    room = Room(2.0, 2.0, 2.0, 2.0)
    found = shares_of(_even(), room, "endwise")
    solid_angle = 4.0 * math.asin(4.0 * 4.0 / (4.0 * 4.0 + 4.0 * 2.0**2))
    assert found.floor == pytest.approx(100.0 * solid_angle, rel=0.02)
    assert found.floor + found.walls == pytest.approx(100.0 * 2.0 * math.pi, rel=1e-9)
    assert found.ceiling == 0.0


def test_flux_has_its_own_term() -> None:
    """CIE 117: of the same distribution, 8 log10 of the flux's ratio."""
    shares = shares_of(_even(), WORKED, "endwise")
    double = shares_of(_even(200.0), WORKED, "endwise")
    first = rating(_even(), WORKED, "endwise", shares, REFLECTANCES[0])
    second = rating(_even(200.0), WORKED, "endwise", double, REFLECTANCES[0])
    assert second - first == pytest.approx(8.0 * math.log10(2.0), abs=1e-9)


def test_the_table_is_whole_and_darker_rooms_glare_more() -> None:
    rows = list(table(_luminaire(), 1.0))
    assert len(rows) == 2 * len(ROOMS)
    for _, _, ratings in rows:
        assert len(ratings) == len(REFLECTANCES)
        assert ratings[-1] > ratings[0]


def test_without_an_opening_there_is_no_luminance() -> None:
    point = Photometry(np.array([0.0, 90.0]), np.zeros(1), np.array([[1.0, 1.0]]))
    with pytest.raises(ValueError, match="opening"):
        rating(point, WORKED, "endwise", Shares(0.0, 1.0, 1.0), REFLECTANCES[0])
