"""Photometric files as intensity profiles."""

import math

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.luminaires import PhotometricProfile
from nocturne_scene.photometry import files
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.spectra.published import Floats

# Steps of the vertical angle, half as many as of the horizontal one, in a sum over all directions.
_STEPS = 360


def compile_profile(workspace: Workspace, profile: PhotometricProfile) -> scene_pb2.IntensityProfile:
    """Return the intensities of a file over its angles, without the directions that the angles are from.

    In W sr-1 nm-1 over a radiance of 1 cd/m2: a spectrum of that luminance makes them the file's candelas.
    Raises Unusable.
    """
    digest = workspace.asset(profile.asset, ".profile.asset")
    try:
        photometry = files.read(workspace.read(digest, photometric_files.MAX_BYTES))
    except photometric_files.BadPhotometryError as error:
        raise Unusable(str(error), ".profile.asset") from None
    if profile.lumens is not None:
        flux = photometric_files.flux(photometry)
        if not flux > 0:
            raise Unusable("the file has no light that could be scaled", ".profile.lumens")
        photometry = photometric_files.scaled(photometry, profile.lumens / flux)
    horizontal, candela = photometry.horizontal, photometry.candela
    if len(horizontal) > 1:
        # Files count anticlockwise seen from above, and the axis points down: clockwise about the axis.
        horizontal, candela = (360 - horizontal)[::-1], candela[::-1]
    return scene_pb2.IntensityProfile(
        vertical=[math.radians(angle) for angle in photometry.vertical],
        horizontal=[math.radians(angle) for angle in horizontal],
        values=candela.ravel().tolist(),
    )


def flux_behind(profile: scene_pb2.IntensityProfile, normal: Floats) -> tuple[float, float]:
    """Flux to the side that `normal` points away from, and to both sides, lm."""
    vertical = (np.arange(_STEPS) + 0.5) * math.pi / _STEPS
    horizontal = (np.arange(2 * _STEPS) + 0.5) * math.pi / _STEPS
    values = np.array(profile.values).reshape(-1, len(profile.vertical))
    of_rows = np.array([np.interp(vertical, profile.vertical, row, left=0.0, right=0.0) for row in values])
    if len(profile.horizontal) > 1:
        candela = np.array([np.interp(horizontal, profile.horizontal, each) for each in of_rows.T])
    else:
        candela = np.repeat(of_rows.T, len(horizontal), axis=1)
    axis, zero = (np.array([each.x, each.y, each.z]) for each in (profile.axis, profile.zero))
    cosine = np.cos(vertical)[:, None] * (axis @ normal) + np.sin(vertical)[:, None] * (
        np.cos(horizontal) * (zero @ normal) + np.sin(horizontal) * (np.cross(axis, zero) @ normal)
    )
    flux = candela * np.sin(vertical)[:, None] * (math.pi / _STEPS) ** 2
    return float(flux[cosine < 0].sum()), float(flux.sum())
