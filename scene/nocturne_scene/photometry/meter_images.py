"""Images of an intensity meter as photometry."""

from collections.abc import Mapping

import numpy as np

from nocturne_scene.bands import band_middle, is_band
from nocturne_scene.photometry.intensities import MAX_ANGLES, MAX_VALUES, Photometry, Spectrum
from nocturne_scene.spectra.published import Floats


def photometry_of(
    candela: Floats, keywords: Mapping[str, str], spectrum: Spectrum | None = None
) -> Photometry:
    """The intensities that an intensity meter's pixels show, cd, shape (height, width), as they lie in it.

    A pixel is a mean over its solid angle, so its angles are the means over that: the middle of its column,
    and a little more than the middle of its row, seen from the next pole. At the poles is the mean of the
    next row, at the horizontal angles 0 and 360 degrees the mean of the columns on both sides; one column is
    a lamp that is the same all around. Raises ValueError where a photometric file can't hold as many angles.
    """
    height, width = candela.shape
    rows = _with_rims(candela, 1)
    vertical = np.concatenate([[0.0], _mean_vertical(height), [180.0]])
    horizontal = np.zeros(1, dtype=np.float64)
    if width > 1:
        middles = (np.arange(width) + 0.5) * (360.0 / width)
        horizontal = np.concatenate([[0.0], middles, [360.0]])
    if max(rows.shape) > MAX_ANGLES or rows.size > MAX_VALUES:
        raise ValueError(
            f"{width} x {height} pixels are too many: a photometric file has at most {MAX_ANGLES} angles "
            f"of a kind and {MAX_VALUES} values"
        )
    return Photometry(vertical, horizontal, rows, keywords=keywords, spectrum=spectrum)


def spectrum_of(bands: Mapping[str, Floats]) -> Spectrum | None:
    """Of all light that a meter shows, from pixels of its bands, W/sr nm, by their names; its largest value
    is 1. None without bands, or without light."""
    middles = {name: band_middle(name) for name in bands if is_band(name)}
    names = sorted(middles, key=middles.__getitem__)
    if not names:
        return None
    rows = -np.diff(np.cos(np.linspace(0.0, np.pi, bands[names[0]].shape[0] + 1)))
    values = np.array([float((bands[name] * rows[:, None]).sum()) for name in names])
    if len(names) < 2 or not values.max() > 0:
        return None
    return np.array([middles[name] for name in names]), np.maximum(values, 0.0) / values.max()


def _mean_vertical(count: int) -> Floats:
    """Degrees: for each of so many rows the integral of v sin(v) over that of sin(v)."""
    v = np.linspace(0.0, np.pi, count + 1)
    return np.asarray(np.rad2deg(np.diff(np.sin(v) - v * np.cos(v)) / -np.diff(np.cos(v))), dtype=np.float64)


def errors_of(error: Floats) -> Floats:
    """Standard errors of a meter's pixels as those of `photometry_of`'s intensities: pixels know nothing of
    each other."""
    return np.asarray(np.sqrt(_with_rims(np.square(error), 2)), dtype=np.float64)


def flux_of(candela: Floats, error: Floats) -> tuple[float, float]:
    """The light that a meter's pixels show, lm, and its standard error."""
    height, width = candela.shape
    solid_angles = (2 * np.pi / width) * -np.diff(np.cos(np.linspace(0.0, np.pi, height + 1)))[:, None]
    return float((candela * solid_angles).sum()), float(np.sqrt(np.square(error * solid_angles).sum()))


def _with_rims(values: Floats, power: int) -> Floats:
    """By column, then row, with the poles, and with the seam at 0 and 360 degrees where there are columns;
    `power` 1: of means, 2: of variances."""
    poles = [np.full((1, row.size), row.sum() / row.size**power) for row in (values[0], values[-1])]
    rows = np.concatenate([poles[0], values, poles[1]]).T
    if values.shape[1] == 1:
        return rows
    seam = (rows[:1] + rows[-1:]) / 2**power
    # A pole is one direction.
    seam[:, [0, -1]] = rows[:1, [0, -1]]
    return np.concatenate([seam, rows, seam])
