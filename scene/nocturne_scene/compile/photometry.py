"""Photometric files as intensity profiles."""

import math

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.luminaires import PhotometricProfile
from nocturne_scene.photometry import ies as photometric_files


def compile_profile(workspace: Workspace, profile: PhotometricProfile) -> scene_pb2.IntensityProfile:
    """Return the intensities of a file over its angles, without the directions that the angles are from.

    In W sr-1 nm-1 over a radiance of 1 cd/m2: a spectrum of that luminance makes them the file's candelas.
    Raises Unusable.
    """
    digest = workspace.asset(profile.asset, ".profile.asset")
    try:
        photometry = photometric_files.read(workspace.read(digest, photometric_files.MAX_BYTES))
    except photometric_files.BadPhotometryError as error:
        raise Unusable(str(error), ".profile.asset") from None
    if profile.lumens is not None:
        flux = photometric_files.flux(photometry)
        if not flux > 0:
            raise Unusable("the file has no light that could be scaled", ".profile.lumens")
        photometry = photometric_files.scaled(photometry, profile.lumens / flux)
    horizontal, candela = photometry.horizontal, photometry.candela
    if len(horizontal) > 1:
        # Files count anticlockwise seen from above, and the axis points down: the other way about the axis.
        horizontal, candela = (360 - horizontal)[::-1], candela[::-1]
    return scene_pb2.IntensityProfile(
        vertical=[math.radians(angle) for angle in photometry.vertical],
        horizontal=[math.radians(angle) for angle in horizontal],
        values=candela.ravel().tolist(),
    )
