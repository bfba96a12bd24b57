"""Metals of three numbers, against Fresnel's equations by channel."""

import numpy as np
import pytest
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.spectra import published


def seen(n: object, k: object) -> np.ndarray:
    """Linear sRGB of the reflection at normal incidence under D65."""
    visible = published.visible_wavelengths()
    observer = published.observer("CIE 1931 2 degree")
    daylight = np.interp(visible, *published.illuminant("D65"))
    real, imaginary = (colours.values_of(each, visible) for each in (n, k))
    reflected = ((real - 1) ** 2 + imaginary**2) / ((real + 1) ** 2 + imaginary**2)
    xyz = (observer * (daylight * reflected)[:, None]).sum(axis=0) / (observer[:, 1] @ daylight)
    return np.asarray(published.XYZ_TO_SRGB @ xyz)


@pytest.mark.parametrize(
    ("n", "k"),
    [
        ((0.200438, 0.924033, 1.102212), (3.912949, 2.452848, 2.142188)),
        ((0.143, 0.375, 1.442), (3.983, 2.386, 1.603)),
        ((1.657, 0.880, 0.521), (9.224, 6.270, 4.837)),
    ],
    ids=["copper", "gold", "aluminium"],
)
def test_the_colour_at_normal_incidence_is_that_of_the_channels(
    n: tuple[float, float, float], k: tuple[float, float, float]
) -> None:
    channels = ((np.array(n) - 1) ** 2 + np.array(k) ** 2) / ((np.array(n) + 1) ** 2 + np.array(k) ** 2)
    found = seen(metals.part_of_rgb(n), metals.part_of_rgb(k))
    # A spectrum that gives the three numbers is not the one that gives their Fresnel terms.
    assert found == pytest.approx(channels, abs=0.06)


def test_equal_numbers_are_one_number() -> None:
    assert metals.part_of_rgb((1.5, 1.5, 1.5)) == 1.5
