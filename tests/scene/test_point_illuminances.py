"""A point's illuminances against closed forms, and colour temperatures against published ones."""

import math
import warnings
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.directions import directions_of
from nocturne_scene.photometry.point_illuminances import point_reading
from nocturne_scene.quantities import ILLUMINANCE, LUMINANCE
from nocturne_scene.spectra import published
from nocturne_scene.spectra.temperature import colour_temperature

from .eyes import Values, image_of, with_sources


def _read(image: Values, azimuth: float = 0.0, error: float = 0.0) -> dict[str, tuple[float, float]]:
    found = point_reading(image_of(image, error), LUMINANCE, azimuth)
    return {each.name: (each.lux, each.error) for each in found.illuminances}


def test_an_even_light_is_pi_times_its_luminance_for_all_bodies() -> None:
    found = _read(np.full((128, 256), 100.0), 33.0, error=0.1)
    assert len(found) == 10
    for name, (lux, error) in found.items():
        assert lux == pytest.approx(100.0 * math.pi, rel=3e-4), name
        assert 0.0 < error < 0.01 * lux


@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 0.0), (50.0, 30.0), (-120.0, -20.0)])
@pytest.mark.parametrize("eye", [0.0, 70.0])
def test_a_small_lamp(azimuth: float, elevation: float, eye: float) -> None:
    """E at right angles to it is L times its solid angle, and every body gets its projected part over its
    area: cylinder cos(e) / pi, its half (1 + cos) of the azimuth, half-sphere (1 + sin(e)) / 4, sphere 1 / 4.
    """
    image = with_sources("panorama", [(azimuth, elevation, 2.0, 1e5)], 0.0, (1024, 512))
    seen = directions_of("panorama", 1024, 512)
    full = float((image * seen.solid_angle).sum())
    found = {name: lux / full for name, (lux, _) in _read(image, eye).items()}
    a, e = math.radians(azimuth - eye), math.radians(elevation)

    def near(truth: float) -> Any:
        return pytest.approx(max(0.0, truth), rel=2e-3, abs=2e-3 if truth > 0.01 else 2e-2)

    assert found["horizontal, facing up"] == near(math.sin(e))
    assert found["vertical, ahead"] == near(math.cos(e) * math.cos(a))
    assert found["vertical, right"] == near(math.cos(e) * math.sin(a))
    assert found["cylindrical"] == near(math.cos(e) / math.pi)
    assert found["semicylindrical, ahead"] == near(math.cos(e) * (1 + math.cos(a)) / math.pi)
    assert found["hemispherical"] == near((1.0 + math.sin(e)) / 4.0)
    assert found["spherical"] == pytest.approx(0.25)


def test_the_cylinder_averages_vertical_planes() -> None:
    """The definition, by 36 planes, of a scene without symmetry; and the errors of a mean over pixels."""
    image = with_sources("panorama", [(20.0, 40.0, 15.0, 3e3), (-100.0, 10.0, 8.0, 9e3)], 50.0, (256, 128))
    planes = [_read(image, 10.0 * step)["vertical, ahead"][0] for step in range(36)]
    found = point_reading(image_of(image, 0.2), LUMINANCE)
    by_name = {each.name: each for each in found.illuminances}
    assert by_name["cylindrical"].lux == pytest.approx(float(np.mean(planes)), rel=2e-3)
    expected = by_name["cylindrical"].lux / by_name["horizontal, facing up"].lux
    assert found.modelling == pytest.approx(expected)
    random = np.random.default_rng(2)
    drawn = [
        point_reading(
            image_of(image * (1.0 + 0.2 * random.standard_normal(image.shape))), LUMINANCE
        ).modelling
        for _ in range(60)
    ]
    # 60 drawings know a deviation to 9 %.
    assert float(np.std(drawn, ddof=1)) == pytest.approx(found.modelling_error, rel=0.3)


def test_other_images_are_refused() -> None:
    image = image_of(np.ones((8, 16)))
    with pytest.raises(InputError, match="made of luminance"):
        point_reading(image, ILLUMINANCE)
    with pytest.raises(InputError, match="twice as wide as high"):
        point_reading(image_of(np.ones((8, 8))), LUMINANCE)


_PUBLISHED = {"A": 2856, "D50": 5003, "D55": 5503, "D65": 6504, "D75": 7504}
_PUBLISHED |= {"FL1": 6430, "FL2": 4230, "FL4": 2940, "FL7": 6500, "FL11": 4000, "FL12": 3000}


@pytest.mark.parametrize("name", _PUBLISHED)
def test_illuminants_have_the_published_temperatures(name: str) -> None:
    """CIE 15:2004, 3.1 and table T.8, which is rounded to 10 K; and colour-science's by Ohno's method (Leukos
    10, 2014), which is exact to 1 K."""
    with warnings.catch_warnings():
        # It misses Matplotlib, which nobody here needs.
        warnings.simplefilter("ignore")
        import colour
    wavelengths = published.visible_wavelengths()
    knots, values = published.illuminant(name)
    xyz = np.interp(wavelengths, knots, values, right=0.0) @ published.observer("CIE 1931 2 degree")
    found = colour_temperature(xyz, np.zeros((3, 3)))
    assert found.kelvin == pytest.approx(_PUBLISHED[name], rel=2e-3)
    below = xyz @ [1.0, 15.0, 3.0]
    kelvin, duv = colour.uv_to_CCT([4.0 * xyz[0] / below, 6.0 * xyz[1] / below], method="Ohno 2013")
    assert found.kelvin == pytest.approx(kelvin, rel=2e-4)
    assert found.duv == pytest.approx(duv, abs=2e-6)


def test_duv_has_its_sign_and_errors_are_those_of_drawings() -> None:
    """D65 lies 0.0032 above the locus (ANSI C78.377 has it as 0.0032)."""
    xyz = np.array([95.047, 100.0, 108.883])
    covariance = np.array([[0.04, 0.01, 0.0], [0.01, 0.09, 0.02], [0.0, 0.02, 0.16]])
    found = colour_temperature(xyz, covariance)
    assert found.duv == pytest.approx(0.0032, abs=5e-5)
    assert found.kelvin == pytest.approx(6504.0, abs=2.0)
    random = np.random.default_rng(1)
    drawn = [
        colour_temperature(each, covariance) for each in random.multivariate_normal(xyz, covariance, 800)
    ]
    assert np.std([each.kelvin for each in drawn]) == pytest.approx(found.kelvin_error, rel=0.1)
    assert np.std([each.duv for each in drawn]) == pytest.approx(found.duv_error, rel=0.1)
    assert math.isnan(colour_temperature(np.array([20.0, 50.0, 5.0]), covariance).kelvin)
