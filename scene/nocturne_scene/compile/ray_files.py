"""Lamps as the rays of files."""

from collections.abc import Iterator

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.photometry import table_of
from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.problems import path
from nocturne_scene.document.ray_files import RayFile
from nocturne_scene.photometry import far_field, tm25


def compile_ray_files(workspace: Workspace) -> Iterator[scene_pb2.RaySet]:
    """Their rays, each with its lumens as power, and the spectrum of a lumen."""
    for index, lamp in enumerate(workspace.document.ray_files):
        place = path(("ray_files", index))
        with workspace.problems_at(place):
            yield _compiled(workspace, lamp)
        workspace.report_unseen(lamp.radiance, f"{place}.radiance")


def _compiled(workspace: Workspace, lamp: RayFile) -> scene_pb2.RaySet:
    digest = workspace.asset(lamp.asset, ".asset")
    try:
        rays = tm25.read(workspace.blobs.path(digest.hex()))
        lumens = far_field.lumens_of(rays)
    except (tm25.BadRayFileError, ValueError) as error:
        raise Unusable(str(error), ".asset") from None
    total = float(lumens.sum())
    if not total > 0:
        raise Unusable("no ray has visible light", ".asset")
    lumens *= lamp.dimming * (1.0 if lamp.lumens is None else lamp.lumens / total)
    stands = workspace.frame.after(placement_of(lamp))
    table = np.empty((len(lumens), 7), dtype="<f4")
    table[:, :3] = stands.points(rays.starts.astype(np.float64))
    table[:, 3:6] = stands.turned(rays.directions.astype(np.float64))
    table[:, 6] = lumens
    file = workspace.temporary("rays")
    table.tofile(file)
    return scene_pb2.RaySet(
        blob=workspace.keep_file(file),
        count=len(table),
        spectrum=workspace.spectra.index_of(_of_a_lumen(workspace, lamp, rays)),
        light_group=workspace.light_groups.number(lamp.light_group),
    )


def _of_a_lumen(workspace: Workspace, lamp: RayFile, rays: tm25.RayFile) -> scene_pb2.Spectrum:
    if lamp.radiance is not None:
        spectrum = workspace.spectrum(lamp.radiance)
    else:
        spectrum = table_of(far_field.spectrum_of(rays), ".asset")
    # Lumens of W/nm, as luminances are of radiances.
    return spectra.scaled_to_luminance(spectra.radiance(spectrum, workspace.spectral), 1.0)
