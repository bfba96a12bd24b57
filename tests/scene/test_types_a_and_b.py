"""Photometry of types A and B: what a file says of a direction is what luminaires send there."""

import numpy as np
import pytest
from nocturne_scene.photometry import ies
from nocturne_scene.photometry.intensities import Photometry, flux
from nocturne_scene.spectra.published import Floats

_RIGHT_ANGLE = np.linspace(-90.0, 90.0, 181)


def _file(kind: str, vertical: Floats, horizontal: Floats, candela: Floats) -> bytes:
    rows = "\n".join(
        " ".join(map(repr, row)) for row in [vertical.tolist(), horizontal.tolist(), *candela.tolist()]
    )
    counts = f"{len(vertical)} {len(horizontal)} {'CBA'.index(kind) + 1}"
    return f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {counts} 2 0 0 0\n1 1 10\n{rows}\n".encode()


def _direction(kind: str, vertical: float, horizontal: float) -> Floats:
    """In D (down), Z (photometric horizontal), S (to its right), by LM-63-2002, section 3."""
    v, h = np.deg2rad(vertical), np.deg2rad(horizontal)
    if kind == "A":
        return np.array([-np.sin(v), np.cos(v) * np.cos(h), np.cos(v) * np.sin(h)])
    return np.array([np.cos(h) * np.cos(v), np.cos(h) * np.sin(v), np.sin(h)])


def _candela(photometry: Photometry, direction: Floats) -> float:
    """What a luminaire sends there: linear between angles from the axis and about it, and else dark."""
    axis, zero = np.array(photometry.axis), np.array(photometry.zero)
    across = -np.cross(axis, zero)  # angles increase counter-clockwise for someone who looks along the axis
    away = np.degrees(np.arccos(np.clip(direction @ axis, -1, 1)))
    about = np.degrees(np.arctan2(direction @ across, direction @ zero)) % 360
    rows = [np.interp(away, photometry.vertical, row, left=0, right=0) for row in photometry.candela]
    return float(np.interp(about, photometry.horizontal, rows, left=0, right=0))


@pytest.mark.parametrize(
    ("kind", "photometric_zero", "horizon"), [("A", (-90.0, 0.0), (0.0, 0.0)), ("B", (0.0, 0.0), (90.0, 0.0))]
)
def test_the_two_directions_that_the_standard_names(
    kind: str, photometric_zero: tuple[float, float], horizon: tuple[float, float]
) -> None:
    """Photometric zero is straight down, and photometric horizontal level (LM-63-2002, section 3)."""
    assert _direction(kind, *photometric_zero) == pytest.approx([1, 0, 0], abs=1e-12)
    assert _direction(kind, *horizon) == pytest.approx([0, 1, 0], abs=1e-12)


@pytest.mark.parametrize("kind", ["A", "B"])
def test_a_lambertian_of_1000_lm_has_318_cd_ahead(kind: str) -> None:
    v, h = np.meshgrid(np.deg2rad(_RIGHT_ANGLE), np.deg2rad(_RIGHT_ANGLE))
    found = ies.read(_file(kind, _RIGHT_ANGLE, _RIGHT_ANGLE, 1000 / np.pi * np.cos(v) * np.cos(h)))
    ahead = _direction(kind, 0, 0)
    assert _candela(found, ahead) == pytest.approx(318.30989, rel=1e-6)
    assert flux(found) == pytest.approx(1000, rel=1e-4)
    for direction in np.random.default_rng(1).normal(size=(50, 3)):
        unit = direction / np.linalg.norm(direction)
        expected = 318.30989 * max(0.0, float(unit @ ahead))
        assert _candela(found, unit) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("kind", ["A", "B"])
@pytest.mark.parametrize("span", [(-90.0, 90.0), (-30.0, 50.0), (0.0, 90.0)])
def test_every_value_of_a_file_is_where_it_says(kind: str, span: tuple[float, float]) -> None:
    vertical, horizontal = np.linspace(*span, 9), np.array([-40.0, -10.0, 0.0, 25.0, 60.0])
    values = np.arange(1.0, 46.0).reshape(5, 9)
    found = ies.read(_file(kind, vertical, horizontal, values))
    # Just inside, as at the rim rounding decides.
    inner = (vertical - vertical.mean()) * (1 - 1e-9) + vertical.mean()
    for h, row in zip(horizontal, values, strict=True):
        for v, value in zip(inner, row, strict=True):
            if abs(v) < 89 or kind == "B":  # all horizontal angles meet in the pole
                assert _candela(found, _direction(kind, v, h * (1 - 1e-9))) == pytest.approx(value, rel=1e-6)
    assert _candela(found, _direction(kind, float(vertical.mean()), 61.0)) == 0
    assert _candela(found, -_direction(kind, float(vertical.mean()), 0.0)) == 0


@pytest.mark.parametrize("kind", ["A", "B"])
def test_horizontal_angles_from_0_on_are_of_both_sides(kind: str) -> None:
    vertical, horizontal = np.array([-20.0, 0.0, 20.0]), np.array([0.0, 30.0, 90.0])
    found = ies.read(_file(kind, vertical, horizontal, np.arange(1.0, 10.0).reshape(3, 3)))
    for side in (-30.0, 30.0):
        assert _candela(found, _direction(kind, 0.0, side)) == pytest.approx(5.0)
    with pytest.raises(ValueError, match="type A or B is read, and not written"):
        ies.write(found)
