"""Colours and amounts of light as scene documents write them."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.spectra import published
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.spectra.published import MAX_LUMINOUS_EFFICACY, SRGB_LUMINANCE

Json = Any


@lru_cache(maxsize=1)
def luminance_of_d65() -> float:
    """cd/m2 of the table of D65 (100 at 560 nm) taken as W m-2 sr-1 nm-1."""
    wavelengths, values = published.illuminant("D65")
    visible = published.visible_wavelengths()
    y_bar = published.observer("CIE 1931 2 degree")[:, 1]
    return float(MAX_LUMINOUS_EFFICACY * (np.interp(visible, wavelengths, values) @ y_bar))


def reflectance(rgb: Sequence[float]) -> Json:
    """A reflectance of linear sRGB in [0, 1]; greys are the same at every wavelength."""
    red, green, blue = (float(value) for value in rgb)
    return red if red == green == blue else {"rgb": [red, green, blue]}


def light(rgb: Sequence[float], white: float) -> Json:
    """Radiance of linear sRGB, not negative, of any size; (1, 1, 1) is D65 of `white` cd/m2."""
    brightest = max(rgb)
    if not brightest > 0:
        return 0.0
    luminance = white * math.fsum(part * value for part, value in zip(SRGB_LUMINANCE, rgb, strict=True))
    return {"rgb": [float(value) / brightest for value in rgb], "luminance": luminance}


def scaled(spectrum: Json, factor: float) -> Json:
    """A radiance, or a coefficient, times a factor."""
    if isinstance(spectrum, int | float):
        return spectrum * factor
    if "table" in spectrum and "luminance" not in spectrum:
        return spectrum | {"table": [[at, value * factor] for at, value in spectrum["table"]]}
    if "texture" in spectrum:
        return spectrum | {"spectrum": scaled(spectrum.get("spectrum", 1.0), factor)}
    if "luminance" in spectrum:
        return spectrum | {"luminance": spectrum["luminance"] * factor} if factor > 0 else 0.0
    if "rgb" in spectrum:
        return table(SMOOTH, factor * values_of(spectrum, SMOOTH))
    raise ValueError(f"{sorted(spectrum)} has no size to scale")


def decode_srgb(values: Sequence[float]) -> list[float]:
    """Linear values of sRGB-encoded ones in [0, 1], IEC 61966-2-1."""
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]


def luminance_of(spectrum: Json) -> float:
    """cd/m2 of a radiance (or cd of an intensity) as `light` and tables give it."""
    if isinstance(spectrum, int | float):
        y_bar = published.observer("CIE 1931 2 degree")[:, 1]
        return float(MAX_LUMINOUS_EFFICACY * spectrum * y_bar.sum())
    if "luminance" in spectrum:
        return float(spectrum["luminance"])
    knots = np.array(spectrum["table"])
    visible = published.visible_wavelengths()
    values = np.interp(visible, knots[:, 0], knots[:, 1], left=0.0, right=0.0)
    return float(MAX_LUMINOUS_EFFICACY * (values @ published.observer("CIE 1931 2 degree")[:, 1]))


def coefficient(rgb: Sequence[float]) -> Json:
    """What linear sRGB of any size, not negative, stands for as a spectrum in 1/m."""
    if len(set(rgb)) == 1:
        return float(rgb[0])
    # Half of the range that smooth spectra have, where they are least steep.
    factor = 2 * max(rgb)
    values = values_of({"rgb": [value / factor for value in rgb]}, SMOOTH)
    return table(SMOOTH, factor * values)


SMOOTH = np.arange(360.0, 831.0, 5.0)
"""nm between which smooth spectra are straight lines."""


def knots(*spectra: Json) -> NDArray[np.float64]:
    """Wavelengths between which products of spectra are nearly straight lines; one if all are constant."""
    if all(isinstance(spectrum, int | float) for spectrum in spectra):
        return np.array([550.0])
    own = [
        knot[0] for spectrum in spectra if isinstance(spectrum, dict) for knot in spectrum.get("table", ())
    ]
    return np.union1d(SMOOTH, np.clip(own, SMOOTH[0], SMOOTH[-1]))


def values_of(spectrum: Json, at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of a number, a table or the colour of a reflectance at wavelengths, nm."""
    if isinstance(spectrum, int | float):
        return np.full(at.shape, float(spectrum))
    if "rgb" in spectrum:
        return rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(np.array(spectrum["rgb"])), at)
    pairs = np.array(spectrum["table"])
    ends = {"left": 0.0, "right": 0.0} if spectrum.get("outside") == "zero" else {}
    return np.asarray(np.interp(at, pairs[:, 0], pairs[:, 1], **ends))


def table(at: NDArray[np.float64], values: NDArray[np.float64]) -> Json:
    """A coefficient by wavelength; a number where there is one."""
    if len(at) == 1 or np.all(values == values[0]):
        return float(values[0])
    return {"table": np.stack([at, values], 1).tolist()}
