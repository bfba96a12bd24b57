"""The Sun outside the atmosphere, as a disc at infinity. Numbers and sources: data/sun.toml."""

from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.spectra import solar
from nocturne_scene.spectra.published import STEP, Floats, data_file, visible_wavelengths
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange, means

# Mean over the disc of mu^k, k = 0 ... 5: twice the integral of mu^(k + 1).
_MEANS = 2 / (np.arange(6) + 2)


@dataclass(frozen=True)
class Sun:
    """What `DistantDisc` wants: radiance at the centre of the disc, a_k as differences, half angle in
    radians.
    """

    half_angle: float
    radiance: scene_pb2.Spectrum
    limb_plus: list[scene_pb2.Spectrum]
    limb_minus: list[scene_pb2.Spectrum]


def irradiance(within: WavelengthRange = VISIBLE) -> Floats:
    """Spectral irradiance across the beam at 1 au, W m-2 nm-1, at a range's grid.

    From 360 to 830 nm the table's values at whole nm; elsewhere its means around them, which keep its
    integral, zero below 280 nm.
    """
    visible = np.array(data_file("sun.toml")["irradiance"]["values"], dtype=np.float64)
    if within.is_usual:
        return visible
    grid = within.grid()
    values = means(*solar.table("extraterrestrial"), within)
    known, seen = visible_wavelengths(), (grid >= VISIBLE.first) & (grid <= VISIBLE.last)
    values[seen] = np.interp(grid[seen], known, visible)
    return values


def half_angle() -> float:
    """Angular radius of the disc at 1 au, radians."""
    return float(np.deg2rad(data_file("sun.toml")["disc"]["angular_radius_arcseconds"] / 3600))


def limb_darkening(within: WavelengthRange = VISIBLE) -> Floats:
    """a_k at a range's grid, shape (n, 6), linear between the measured ones, held beyond; their sum is 1."""
    rows = np.array(data_file("sun.toml")["limb_darkening"]["rows"], dtype=np.float64)
    wavelengths = within.grid()
    a = np.stack([np.interp(wavelengths, rows[:, 0], rows[:, 1 + k]) for k in range(6)], axis=1)
    return np.asarray(a / a.sum(axis=1, keepdims=True))


def sun(distance_au: float = 1.0, *, darkened: bool = True, within: WavelengthRange = VISIBLE) -> Sun:
    """Return the Sun's disc from a distance in astronomical units; its irradiance is `irradiance` /
    distance^2.

    Without limb darkening the radiance is the disc's mean. Radiance of the mean is irradiance over
    pi sin^2(half angle), which is exact for a disc seen face on.
    """
    angle = float(np.arcsin(np.sin(half_angle()) / distance_au))
    mean = irradiance(within) / (np.pi * np.sin(half_angle()) ** 2)
    if not darkened:
        return Sun(angle, _table(mean, within), [], [])
    a = limb_darkening(within)
    return Sun(
        angle,
        _table(mean / (a @ _MEANS), within),
        [_table(np.maximum(a[:, k], 0), within) for k in range(6)],
        [_table(np.maximum(-a[:, k], 0), within) for k in range(6)],
    )


def _table(values: Floats, within: WavelengthRange) -> scene_pb2.Spectrum:
    if not np.any(values):
        return scene_pb2.Spectrum(values=[0.0])
    return scene_pb2.Spectrum(first_nm=within.first, step_nm=STEP, values=values.astype(np.float32).tolist())
