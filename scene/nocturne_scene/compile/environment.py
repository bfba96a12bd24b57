"""Environment maps."""

import io
import math

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.sensors import unit, vector
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.spectra import tables as spectra
from nocturne_scene.textures import environment_maps


def compile_map(workspace: Workspace, environment: EnvironmentMap) -> scene_pb2.EnvironmentMap:
    """Return the map with its frame: z up, x in the image's middle, y to the left of it. Raises Unusable."""
    file = workspace.blobs.path(workspace.asset(environment.asset, ".asset").hex())
    texels = io.BytesIO()
    try:
        columns, rows = environment_maps.convert(file, texels)
    except environment_maps.UnusableImageError as error:
        raise Unusable(str(error), ".asset") from None
    _, d65 = rgb_spectra.d65_of_luminance(environment.luminance)
    z = unit(np.array(environment.up))
    ahead = np.array(environment.forward)
    ahead = unit(ahead - (ahead @ z) * z)
    left = np.cross(z, ahead)
    turn = math.radians(environment.rotate_degrees)
    return scene_pb2.EnvironmentMap(
        blob=workspace.keep(texels.getvalue()),
        columns=columns,
        rows=rows,
        spectrum=workspace.spectra.index_of(spectra.at_visible(d65)),
        x=vector(math.cos(turn) * ahead + math.sin(turn) * left),
        y=vector(math.cos(turn) * left - math.sin(turn) * ahead),
        z=vector(z),
    )
