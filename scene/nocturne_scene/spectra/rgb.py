"""Smooth spectra of linear sRGB colours, after W. Jakob and J. Hanika, "A low-dimensional function space for
efficient spectral upsampling", Computer Graphics Forum 38(2), 2019.

A spectrum is S(c0 l^2 + c1 l + c2), l in nm, with the sigmoid S(x) = 1/2 + x / (2 sqrt(1 + x^2)) (equations 2
and 5). Coefficients are looked up in the table data/rgb_table.bin, which tools/make_rgb_table.py of the
coordinator makes.
"""

import hashlib
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from nocturne_scene.spectra.published import (
    MAX_LUMINOUS_EFFICACY,
    Floats,
    data_bytes,
    illuminant,
    observer,
    visible_wavelengths,
)

# Linear sRGB of XYZ (IEC 61966-2-1), from its primaries and the white that the tables of D65 and the observer
# give, so that the reflectance 1 under D65 is exactly (1, 1, 1).
_PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])

# Nearer to 0 and 1 the sigmoid's argument grows without bound, and float32 loses the difference.
_DARKEST = 1e-4
_BRIGHTEST = 1 - 1e-4


@dataclass(frozen=True)
class Table:
    """`scales` has the `resolution` values of the brightest channel; `coefficients` has the shape
    (3, resolution, resolution, resolution, 3): brightest channel, scale, second ratio, first ratio, c0 to c2.

    With the brightest channel m (0 red, 1 green, 2 blue), the first ratio is channel (m + 1) % 3 over it, the
    second channel (m + 2) % 3; both have equal steps from 0 to 1.
    """

    scales: NDArray[np.float32]
    coefficients: NDArray[np.float32]

    def blob(self) -> bytes:
        """Serialise as `RgbTable` in the compiled scene says."""
        return self.scales.astype("<f4").tobytes() + self.coefficients.astype("<f4").tobytes()


def resolution_of(blob: bytes) -> int:
    """Return the resolution of a table from its size; ValueError if none has it."""
    for resolution in range(2, 129):
        if len(blob) == 4 * resolution + 36 * resolution**3:
            return resolution
    raise ValueError(f"no table has {len(blob)} bytes")


@lru_cache(maxsize=1)
def table_blob() -> bytes:
    """The table as a blob of the compiled scene."""
    return data_bytes("rgb_table.bin")


@lru_cache(maxsize=1)
def table_digest() -> str:
    """SHA-256 of the table."""
    return hashlib.sha256(table_blob()).hexdigest()


@lru_cache(maxsize=1)
def table() -> Table:
    """The table, read."""
    blob = table_blob()
    resolution = resolution_of(blob)
    numbers = np.frombuffer(blob, dtype="<f4")
    return Table(numbers[:resolution], numbers[resolution:].reshape(3, resolution, resolution, resolution, 3))


@lru_cache(maxsize=1)
def xyz_to_rgb() -> Floats:
    """The matrix from XYZ (Y of white = 1) to linear sRGB."""
    xyz = np.array([[x / y, 1.0, (1 - x - y) / y] for x, y in _PRIMARIES]).T
    return np.asarray(np.linalg.inv(xyz * np.linalg.solve(xyz, _white())))


@lru_cache(maxsize=1)
def rgb_weights() -> Floats:
    """Shape (471, 3): times a reflectance at `visible_wavelengths`, summed, gives linear sRGB under D65."""
    weights = observer("CIE 1931 2 degree") * _d65()[:, None]
    return np.asarray(weights / weights[:, 1].sum() @ xyz_to_rgb().T)


def sigmoid(x: Floats) -> Floats:
    """S(x), in [0, 1]."""
    return np.asarray(0.5 + 0.5 * x / np.hypot(1.0, x))


def spectra_of(coefficients: npt.ArrayLike, wavelengths: Floats) -> Floats:
    """Evaluate coefficients of shape (..., 3) at wavelengths in nm of shape (n,): shape (..., n)."""
    c = np.asarray(coefficients, dtype=np.float64)
    return sigmoid((c[..., :1] * wavelengths + c[..., 1:2]) * wavelengths + c[..., 2:])


def rgb_to_coefficients(rgb: Floats) -> NDArray[np.float32]:
    """Look up c0, c1, c2 of reflectances: linear sRGB of shape (..., 3), taken to the nearest in [0, 1].

    Greys are exact (to _DARKEST at both ends); colours are trilinear between the table's entries, along the
    scale in the argument that the sigmoid gives it: coefficients of dark colours are nearly straight in it.
    """
    values = np.clip(np.asarray(rgb, dtype=np.float64), 0.0, 1.0)
    found = _looked_up(values.reshape(-1, 3))
    grey = np.ptp(values, axis=-1).reshape(-1) == 0
    found[grey] = 0.0
    found[grey, 2] = _inverse_sigmoid(values.reshape(-1, 3)[grey, 0])
    return found.reshape(values.shape).astype(np.float32)


def emission(rgb: Floats) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return scales, shape (...), and coefficients, shape (..., 3), of radiance = scale x S x D65.

    `rgb` is linear sRGB of any size, shape (..., 3), none negative. The shape is that of the reflectance of
    `rgb` over twice its brightest channel, where the sigmoid is smoothest; the scale makes the luminance that
    of the colour, R, G, B of 1 being the luminance of the D65.
    """
    values = np.maximum(np.asarray(rgb, dtype=np.float64), 0.0)
    brightest = values.max(axis=-1, keepdims=True)
    halved = np.divide(values, 2 * brightest, out=np.zeros_like(values), where=brightest > 0)
    coefficients = rgb_to_coefficients(halved)
    shares = spectra_of(coefficients, _coarse_wavelengths()) @ _coarse_luminance()
    scales = (values @ _luminance()) / shares
    return scales.astype(np.float32), coefficients


def emission_of_pixels(rgb: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return scale, c0, c1, c2 of many colours, shape (n, 4), close to what `emission` returns for each.

    Of half its brightest channel, a colour is a point in a square, one for each channel that may be the
    brightest. The coefficients are linear in the table's cells there, and interpolated exactly; the scale is
    interpolated between values of `emission` at `_FINER` points on each edge of a cell, which changes it by
    less than 0.4 % for saturated colours and hardly for others.
    """
    values = np.maximum(rgb, np.float32(0))
    found = _emission_table()
    edge = found.shape[1]
    first = values.argmax(axis=1)
    rows = np.arange(len(values))
    brightest = values[rows, first]
    divisor = np.where(brightest > 0, brightest, np.float32(1))
    x, y = (values[rows, (first + shift) % 3] / divisor * np.float32(edge - 1) for shift in (1, 2))
    left, top = (np.minimum(axis.astype(np.int32), edge - 2) for axis in (x, y))
    right_part, low_part = (x - left)[:, None], (y - top)[:, None]
    entries = found.reshape(-1, 4)
    corner = (first.astype(np.int32) * edge + top) * edge + left
    upper: NDArray[np.float32] = entries[corner]
    upper += right_part * (entries[corner + 1] - upper)
    lower = entries[corner + edge]
    lower += right_part * (entries[corner + edge + 1] - lower)
    upper += low_part * (lower - upper)
    upper[:, 0] *= brightest
    return np.asarray(upper)


_FINER = 4


@lru_cache(maxsize=1)
def _emission_table() -> NDArray[np.float32]:
    """Shape (3, n, n, 4): brightest channel, second ratio, first ratio; scale over the brightest channel and
    coefficients."""
    edge = (len(table().scales) - 1) * _FINER + 1
    ratio = np.linspace(0.0, 1.0, edge)
    rgb = np.empty((3, edge, edge, 3))
    for brightest in range(3):
        rgb[brightest, ..., brightest] = 1.0
        rgb[brightest, ..., (brightest + 1) % 3] = ratio
        rgb[brightest, ..., (brightest + 2) % 3] = ratio[:, None]
    scales, coefficients = emission(rgb)
    return np.concatenate([scales[..., None], coefficients], axis=-1)


@lru_cache(maxsize=1)
def _coarse_wavelengths() -> Floats:
    return visible_wavelengths()[::5]


@lru_cache(maxsize=1)
def _coarse_luminance() -> Floats:
    """Weights for Y of a spectrum at `_coarse_wavelengths`, linear in between: five times faster, right to
    0.2 %.
    """
    fine, coarse = visible_wavelengths(), _coarse_wavelengths()
    hats = np.maximum(0.0, 1 - np.abs(fine[:, None] - coarse) / (coarse[1] - coarse[0]))
    return np.asarray(_luminance() @ rgb_weights().T @ hats)


def d65_of_luminance(luminance: float) -> tuple[Floats, Floats]:
    """Return wavelengths and radiance of D65 with this luminance in cd/m2: the spectrum that belongs to
    `emission`.

    With 1 cd/m2, RGB (1, 1, 1) has 1 cd/m2.
    """
    y = MAX_LUMINOUS_EFFICACY * (_d65() @ observer("CIE 1931 2 degree")[:, 1])
    return visible_wavelengths(), _d65() * (luminance / y)


def gauss_newton(rgb: Floats, start: Floats) -> tuple[Floats, Floats]:
    """Fit coefficients to reflectances, shapes (n, 3): return coefficients and the largest error of a
    channel.

    Damped Newton steps (Levenberg and Marquardt) on the three residuals, in the wavelength scaled to [0, 1],
    where `start` is too unless zero. The paper fits in CIELAB; we fit the linear channels, which a tracer's
    texture holds.
    """
    wavelengths = visible_wavelengths()
    basis = scaled_basis(wavelengths)
    weights = rgb_weights()
    c = np.array(start, dtype=np.float64)
    damping = np.full(len(c), 1e-3)
    residual, jacobian = _residuals(c, rgb, basis, weights)
    for _ in range(_ITERATIONS):
        normal = np.einsum("nij,nik->njk", jacobian, jacobian)
        scale = np.trace(normal, axis1=1, axis2=2) / 3 + 1e-30
        normal += (damping * scale)[:, None, None] * np.eye(3)
        step = np.linalg.solve(normal, np.einsum("nij,ni->nj", jacobian, residual)[..., None])[..., 0]
        trial = np.clip(c - step, -_LARGEST, _LARGEST)
        trial_residual, trial_jacobian = _residuals(trial, rgb, basis, weights)
        better = np.sum(trial_residual**2, axis=1) < np.sum(residual**2, axis=1)
        c[better], residual[better], jacobian[better] = (
            trial[better],
            trial_residual[better],
            trial_jacobian[better],
        )
        damping = np.where(better, damping / 4, damping * 4).clip(1e-12, 1e6)
    return c, np.abs(residual).max(axis=1)


_ITERATIONS = 60
# Of scaled coefficients: the sigmoid is then within 1e-7 of 0 or 1 nearly everywhere.
_LARGEST = 1e3


def scaled_basis(wavelengths: Floats) -> Floats:
    """t^2, t, 1 with t from 0 at the first wavelength to 1 at the last, shape (n, 3)."""
    t = (wavelengths - wavelengths[0]) / (wavelengths[-1] - wavelengths[0])
    return np.stack([t * t, t, np.ones_like(t)], axis=1)


def unscaled(c: Floats) -> Floats:
    """Turn coefficients of t into those of nm, shape (..., 3)."""
    wavelengths = visible_wavelengths()
    a = 1 / (wavelengths[-1] - wavelengths[0])
    b = -wavelengths[0] * a
    c0, c1, c2 = c[..., 0], c[..., 1], c[..., 2]
    return np.stack([c0 * a * a, 2 * c0 * a * b + c1 * a, c0 * b * b + c1 * b + c2], axis=-1)


def _residuals(c: Floats, rgb: Floats, basis: Floats, weights: Floats) -> tuple[Floats, Floats]:
    x = c @ basis.T
    residual = sigmoid(x) @ weights - rgb
    slope = 0.5 / np.hypot(1.0, x) ** 3
    jacobian = np.stack([(slope * basis[:, j]) @ weights for j in range(3)], axis=-1)
    return residual, jacobian


def _inverse_sigmoid(values: Floats) -> Floats:
    centred = np.clip(values, _DARKEST, _BRIGHTEST) - 0.5
    return np.asarray(centred / np.sqrt(0.25 - centred**2))


def _looked_up(rgb: Floats) -> Floats:
    found = table()
    last = len(found.scales) - 1
    brightest = np.argmax(rgb, axis=1)
    rows = np.arange(len(rgb))
    scale = rgb[rows, brightest]
    divisor = np.where(scale > 0, scale, 1.0)
    first, second = (rgb[rows, (brightest + shift) % 3] / divisor * last for shift in (1, 2))
    # Positions along the axes of the table.
    along = np.interp(
        _inverse_sigmoid(scale), _inverse_sigmoid(found.scales.astype(np.float64)), np.arange(last + 1.0)
    )
    z, y, x = (np.minimum(axis.astype(int), last - 1) for axis in (along, second, first))
    fractions = (along - z, second - y, first - x)
    result = np.zeros((len(rgb), 3))
    for corner in np.ndindex(2, 2, 2):
        weight = np.ones(len(rgb))
        for fraction, side in zip(fractions, corner, strict=True):
            weight = weight * (fraction if side else 1 - fraction)
        result += weight[:, None] * found.coefficients[brightest, z + corner[0], y + corner[1], x + corner[2]]
    return result


@lru_cache(maxsize=1)
def _d65() -> Floats:
    return np.asarray(np.interp(visible_wavelengths(), *illuminant("D65")))


@lru_cache(maxsize=1)
def _white() -> Floats:
    xyz = _d65() @ observer("CIE 1931 2 degree")
    return np.asarray(xyz / xyz[1])


def _luminance() -> Floats:
    """Y of linear sRGB."""
    return np.asarray(np.linalg.inv(xyz_to_rgb())[1])
