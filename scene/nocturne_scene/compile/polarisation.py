"""Polarised light: filters as messages, and what a scene does not know of polarisation."""

from collections.abc import Iterator

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.kernels import Polariser, Retarder

_DEPOLARISE = {
    "glazing": "glazings",
    "coated_diffuse": "coated diffuse surfaces",
    "phong": "Phong lobes",
    "principled": "principled surfaces",
    "measured": "measured surfaces",
    "blend": "blends and masks",
}
"""Kernels that leave light unpolarised here, and would not in nature, in words."""


def compile_filter(workspace: Workspace, kernel: Polariser | Retarder) -> scene_pb2.Kernel:
    """Return the message of a polariser or of a wave plate."""
    axis = workspace.frame.turned(np.array(kernel.axis, dtype=np.float64))
    x, y, z = (axis / np.linalg.norm(axis)).tolist()
    made = scene_pb2.PolarisingFilter(axis=scene_pb2.Vector(x=x + 0.0, y=y + 0.0, z=z + 0.0))
    if isinstance(kernel, Polariser):
        made.along = workspace.reflectance(kernel.transmittance)
        made.across = workspace.reflectance(kernel.leakage)
        made.retardance = workspace.reflectance(0.0)
        return scene_pb2.Kernel(polarising_filter=made)
    made.along = made.across = workspace.reflectance(1.0)
    if kernel.retardance_nm is None:
        phase = scene_pb2.Spectrum(values=[np.radians(kernel.retardance_degrees or 0.0)])
    else:
        grid = workspace.spectral.grid()
        phase = spectra.at_grid(
            2 * np.pi * kernel.retardance_nm / grid, workspace.spectral, zero_outside=False
        )
    made.retardance = workspace.spectra.index_of(phase)
    return scene_pb2.Kernel(polarising_filter=made)


def is_polarised(scene: scene_pb2.CompiledScene, kernels: list[scene_pb2.Kernel]) -> bool:
    """Whether photons are to know how light is polarised."""
    filters = any(kernel.HasField("polarising_filter") for kernel in kernels)
    return filters or any(response.stokes for response in scene.sensor.further_responses)


def depolarising(scene: scene_pb2.CompiledScene, kernels: list[scene_pb2.Kernel]) -> Iterator[str]:
    """Sentences about what leaves light unpolarised here alone."""
    if not is_polarised(scene, kernels):
        return
    found = {kernel.WhichOneof("model") for kernel in kernels}
    for model, words in _DEPOLARISE.items():
        if model in found:
            yield f"$.kernels: {words} depolarise light here, and polarise it in nature"
    phases = {medium.phase.WhichOneof("shape") for medium in scene.media}
    if phases - {"rayleigh"}:
        yield '$.media: all media depolarise light here but those whose phase function is "rayleigh"'
