"""Photometric files as intensity profiles."""

import math

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.luminaires import PhotometricProfile
from nocturne_scene.document.spectra import TableSpectrum
from nocturne_scene.photometry import files
from nocturne_scene.photometry.intensities import BadPhotometryError, Photometry, Spectrum, flux, scaled
from nocturne_scene.spectra.published import Floats

# Steps of the vertical angle, half as many as of the horizontal one, in a sum over all directions.
_STEPS = 360


def compile_profile(workspace: Workspace, profile: PhotometricProfile) -> scene_pb2.IntensityProfile:
    """Return the intensities of a file over its angles, with axes straight down, in plane C0 and to
    the right of that (types_a_and_b.py).

    In W sr-1 nm-1 over a radiance of 1 cd/m2: a spectrum of that luminance makes them the file's candelas.
    Raises Unusable.
    """
    photometry = _read(workspace, profile)
    if profile.lumens is not None:
        total = flux(photometry)
        if not total > 0:
            raise Unusable("the file has no light that could be scaled", ".profile.lumens")
        photometry = scaled(photometry, profile.lumens / total)
    horizontal, candela = photometry.horizontal, photometry.candela
    if len(horizontal) > 1:
        # Files count anticlockwise seen from above, and the axis points down: clockwise about the axis.
        horizontal, candela = (360 - horizontal)[::-1], candela[::-1]
    return scene_pb2.IntensityProfile(
        axis=_vector(photometry.axis),
        zero=_vector(photometry.zero),
        vertical=[math.radians(angle) for angle in photometry.vertical],
        horizontal=[math.radians(angle) for angle in horizontal],
        values=candela.ravel().tolist(),
    )


def spectrum_of(workspace: Workspace, profile: PhotometricProfile) -> TableSpectrum:
    """Of a file's light, of any size. Raises Unusable."""
    return table_of(_read(workspace, profile).spectrum, ".profile.asset")


def table_of(found: Spectrum | None, suffix: str) -> TableSpectrum:
    """A file's spectrum. Raises Unusable at a place that ends so."""
    if found is None:
        raise Unusable("the file has no spectrum; expected a radiance", suffix)
    knots = [(nm, value) for nm, value in zip(*(each.tolist() for each in found), strict=True)]
    inside = [knot for knot in knots if bounds.MIN_WAVELENGTH <= knot[0] <= bounds.MAX_WAVELENGTH]
    if not inside or len(inside) > bounds.TABLE_KNOTS:
        raise Unusable(
            f"the file's spectrum has {len(inside)} values of {bounds.MIN_WAVELENGTH:g} to "
            f"{bounds.MAX_WAVELENGTH:g} nm; expected 1 to {bounds.TABLE_KNOTS}",
            suffix,
        )
    return TableSpectrum(table=inside)


def _read(workspace: Workspace, profile: PhotometricProfile) -> Photometry:
    digest = workspace.asset(profile.asset, ".profile.asset")
    try:
        return files.read(workspace.read(digest, files.MAX_BYTES))
    except BadPhotometryError as error:
        raise Unusable(str(error), ".profile.asset") from None


def _vector(values: tuple[float, float, float]) -> scene_pb2.Vector:
    return scene_pb2.Vector(x=values[0], y=values[1], z=values[2])


def flux_behind(profile: scene_pb2.IntensityProfile, normal: Floats) -> tuple[float, float]:
    """Flux to the side that `normal` points away from, and to both sides, lm."""
    vertical = (np.arange(_STEPS) + 0.5) * math.pi / _STEPS
    horizontal = (np.arange(2 * _STEPS) + 0.5) * math.pi / _STEPS
    values = np.array(profile.values).reshape(-1, len(profile.vertical))
    of_rows = np.array([np.interp(vertical, profile.vertical, row, left=0.0, right=0.0) for row in values])
    if len(profile.horizontal) > 1:
        known = {"left": 0.0, "right": 0.0}
        candela = np.array([np.interp(horizontal, profile.horizontal, each, **known) for each in of_rows.T])
    else:
        candela = np.repeat(of_rows.T, len(horizontal), axis=1)
    axis, zero = (np.array([each.x, each.y, each.z]) for each in (profile.axis, profile.zero))
    cosine = np.cos(vertical)[:, None] * (axis @ normal) + np.sin(vertical)[:, None] * (
        np.cos(horizontal) * (zero @ normal) + np.sin(horizontal) * (np.cross(axis, zero) @ normal)
    )
    flux = candela * np.sin(vertical)[:, None] * (math.pi / _STEPS) ** 2
    return float(flux[cosine < 0].sum()), float(flux.sum())
