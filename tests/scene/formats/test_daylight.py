"""The Sun's position and light against published values."""

import math
from datetime import datetime

import numpy as np
import pytest
from nocturne_scene.formats.reading.daylight import Place, sky, solar_angles, sun_irradiance
from nocturne_scene.spectra import published, sun


def test_the_sun_on_the_longest_day() -> None:
    """At solar noon on June 21, 12:01:50 in Greenwich, it is 90 degrees less latitude plus 23.44 high."""
    zenith, azimuth = solar_angles(datetime(2010, 6, 21, 12, 1, 50), Place(51.48, 0.0, 0.0))  # noqa: DTZ001
    assert math.degrees(zenith) == pytest.approx(51.48 - 23.44, abs=0.02)
    assert math.degrees(azimuth) == pytest.approx(180, abs=0.2)


@pytest.mark.parametrize("timezone", [0, 9])
def test_the_sun_on_the_equator_at_equinox(timezone: int) -> None:
    """It rises due east and goes overhead: March 20, 2010, 17:32 UTC."""
    hour = (9 + timezone) % 24
    when = datetime(2010, 3, 20, hour, 7, 30)  # noqa: DTZ001
    zenith, azimuth = solar_angles(when, Place(0.0, 0.0, float(timezone)))
    # 12:07:30 is noon there by the equation of time, three hours before it 45 degrees.
    assert math.degrees(zenith) == pytest.approx(45, abs=0.1)
    assert math.degrees(azimuth) == pytest.approx(90, abs=0.3)


def test_sunlight_is_weakened_by_air() -> None:
    """At 550 nm, straight up and with a turbidity of 3, by hand: exp(-(0.1001 + 0.2008 + 0.0298))."""
    table = np.array(sun_irradiance(3.0, 0.0)["table"])
    at = int(np.argwhere(table[:, 0] == 550)[0, 0])
    outside = sun.irradiance()[int(np.argwhere(published.visible_wavelengths() == 550)[0, 0])]
    beta = 0.04608365822050 * 3 - 0.04586025928522
    depth = 0.008735 * 0.55**-4.08 + beta * 0.55**-1.3 + 0.35 * 0.085
    assert depth == pytest.approx(0.1001 + 0.2008 + 0.0298, abs=2e-4)
    assert table[at, 1] / outside == pytest.approx(math.exp(-depth), rel=2e-3)


def test_the_zenith_has_the_luminance_of_the_paper() -> None:
    """(4.0453 T - 4.9710) tan chi - 0.2155 T + 2.4192 kcd/m2; blue, unlike the Sun's surroundings."""
    turbidity, sun_zenith = 3.0, math.radians(50)
    rgb = sky(turbidity, sun_zenith, np.array([0.0]), np.array([sun_zenith]))[0]
    chi = (4 / 9 - turbidity / 120) * (math.pi - 2 * sun_zenith)
    expected = (4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192
    assert rgb @ [0.2126, 0.7152, 0.0722] == pytest.approx(1000 * expected, rel=1e-3)
    assert rgb[2] > 1.5 * rgb[0]
