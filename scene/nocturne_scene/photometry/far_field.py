"""The far field of a ray file: how much of its light goes where, whatever it starts from.

A file's z is the axis of gamma, straight down for a lamp that hangs, and its x the plane C0. Each ray is one
draw of the lamp's light, so a cell has the error of a sum of draws.
"""

import numpy as np

from nocturne_scene.photometry.intensities import Spectrum
from nocturne_scene.photometry.tm25 import RayFile
from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats

_OBSERVER = "CIE 1931 2 degree"
_BIN_NM = 5.0


def lumens_of(rays: RayFile) -> Floats:
    """Luminous flux of each ray, lm. ValueError where the file tells neither it nor a spectrum."""
    if rays.lumens is not None:
        return rays.lumens.astype(np.float64)
    if rays.watts is None:
        raise ValueError("the rays have no flux")
    watts = rays.watts.astype(np.float64)
    if rays.wavelengths is not None:
        return watts * published.MAX_LUMINOUS_EFFICACY * _seen(rays.wavelengths.astype(np.float64))
    if not rays.spectra:
        raise ValueError("the rays have watts and no spectrum, so that their lumens are not known")
    efficacies = np.array([_efficacy(spectrum) for spectrum in rays.spectra])
    each = efficacies[0] if rays.spectrum_of is None else efficacies[rays.spectrum_of]
    return np.asarray(watts * each, dtype=np.float64)


def candela_of(rays: RayFile, columns: int, rows: int) -> tuple[Floats, Floats]:
    """Intensities as an intensity meter's pixels show them, cd, and their standard errors, both of shape
    (rows, columns). Raises ValueError as `lumens_of`."""
    lumens = lumens_of(rays)
    x, y, z = rays.directions.astype(np.float64).T
    row = np.minimum((np.arctan2(np.hypot(x, y), z) * (rows / np.pi)).astype(np.int64), rows - 1)
    around = np.arctan2(-y, x) % (2 * np.pi)
    column = np.minimum((around * (columns / (2 * np.pi))).astype(np.int64), columns - 1)
    cell, count = row * columns + column, len(lumens)
    sums = np.bincount(cell, lumens, rows * columns)
    squares = np.bincount(cell, np.square(lumens), rows * columns)
    variance = np.maximum(0.0, squares - np.square(sums) / count) * count / max(1, count - 1)
    solid = (2 * np.pi / columns) * -np.diff(np.cos(np.linspace(0.0, np.pi, rows + 1)))[:, None]
    shape = rows, columns
    return sums.reshape(shape) / solid, np.sqrt(variance).reshape(shape) / solid


def spectrum_of(rays: RayFile) -> Spectrum | None:
    """Of all light, its largest value 1; None where the file tells none."""
    if rays.wavelengths is not None and rays.watts is not None:
        nm = rays.wavelengths.astype(np.float64)
        first = np.floor(nm.min() / _BIN_NM) * _BIN_NM
        bins = int((nm.max() - first) // _BIN_NM) + 1
        if bins > 100_000:
            return None
        power = np.bincount(((nm - first) // _BIN_NM).astype(np.int64), rays.watts, bins)
        # Straight to zero within a bin on both sides.
        middles = first + _BIN_NM * (np.arange(-1, bins + 1) + 0.5)
        return middles, np.concatenate([[0.0], power, [0.0]]) / power.max()
    if not rays.spectra:
        return None
    if rays.spectrum_of is None or rays.watts is None:
        return rays.spectra[0]
    shares = np.bincount(rays.spectrum_of, rays.watts, len(rays.spectra))
    grid = np.unique(np.concatenate([nm for nm, _ in rays.spectra]))
    parts = [
        share / np.trapezoid(values, nm) * np.interp(grid, nm, values, left=0.0, right=0.0)
        for share, (nm, values) in zip(shares, rays.spectra, strict=True)
        if share > 0 and len(nm) > 1
    ]
    total = np.sum(parts, axis=0) if parts else np.zeros(len(grid))
    return (grid, total / total.max()) if total.max() > 0 else None


def _seen(nm: Floats) -> Floats:
    """V of wavelengths."""
    curve = published.observer(_OBSERVER)[:, 1]
    return np.interp(nm, published.visible_wavelengths(), curve, left=0.0, right=0.0)


def _efficacy(spectrum: Spectrum) -> float:
    """lm/W."""
    nm, values = spectrum
    if len(nm) == 1:
        return float(published.MAX_LUMINOUS_EFFICACY * _seen(nm)[0])
    grid = np.unique(np.concatenate([nm, published.visible_wavelengths()]))
    power = np.interp(grid, nm, values, left=0.0, right=0.0)
    seen = np.trapezoid(power * _seen(grid), grid)
    return float(published.MAX_LUMINOUS_EFFICACY * seen / np.trapezoid(power, grid))
