"""Images of an intensity meter as photometry."""

from collections.abc import Mapping

import numpy as np

from nocturne_scene.photometry.ies import MAX_ANGLES, MAX_VALUES, Photometry
from nocturne_scene.spectra.published import Floats


def photometry_of(candela: Floats, keywords: Mapping[str, str]) -> Photometry:
    """The intensities that an intensity meter's pixels show, cd, shape (height, width), as they lie in it.

    A pixel is a mean over its solid angle, so its angles are the means over that: the middle of its column,
    and a little more than the middle of its row, seen from the next pole. At the poles is the mean of the
    next row, at the horizontal angles 0 and 360 degrees the mean of the columns on both sides; one column is
    a lamp that is the same all around. Raises ValueError where a photometric file can't hold as many angles.
    """
    height, width = candela.shape
    rows = np.concatenate([_pole(candela[0]), candela, _pole(candela[-1])]).T
    vertical = np.concatenate([[0.0], _mean_vertical(height), [180.0]])
    horizontal = np.zeros(1, dtype=np.float64)
    if width > 1:
        seam = (rows[:1] + rows[-1:]) / 2
        rows = np.concatenate([seam, rows, seam])
        middles = (np.arange(width) + 0.5) * (360.0 / width)
        horizontal = np.concatenate([[0.0], middles, [360.0]])
    if max(rows.shape) > MAX_ANGLES or rows.size > MAX_VALUES:
        raise ValueError(
            f"{width} x {height} pixels are too many: a photometric file has at most {MAX_ANGLES} angles "
            f"of a kind and {MAX_VALUES} values"
        )
    return Photometry(vertical, horizontal, rows, keywords=keywords)


def _mean_vertical(count: int) -> Floats:
    """Degrees: for each of so many rows the integral of v sin(v) over that of sin(v)."""
    v = np.linspace(0.0, np.pi, count + 1)
    return np.asarray(np.rad2deg(np.diff(np.sin(v) - v * np.cos(v)) / -np.diff(np.cos(v))), dtype=np.float64)


def _pole(row: Floats) -> Floats:
    return np.full((1, row.size), row.mean(), dtype=np.float64)
