"""Polarised light: filters as messages, and what a scene does not know of polarisation."""

from collections.abc import Iterator

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.kernels import Polariser, Retarder, TwoSided
from nocturne_scene.document.model import SceneDocument, all_surfaces

_NOT_AS_IN_NATURE = {
    "coated_diffuse": "light from the base of coated diffuse surfaces is unpolarised",
    "phong": "Phong lobes leave light unpolarised",
    "principled": "principled surfaces leave light unpolarised where they are metal, have a colour at normal "
    "incidence, or scatter it below their coat",
    "measured": "measured surfaces leave light unpolarised",
}
"""Parts of kernels without amplitudes, in words."""


def asks_for_polarisation(document: SceneDocument) -> bool:
    """Whether photons may have to know how light is polarised: before anything is compiled."""
    if getattr(document.sensor, "stokes", False):
        return True
    for _, surface in all_surfaces(document):
        kernel = surface.kernel
        found = document.kernels.get(kernel) if isinstance(kernel, str) else kernel
        sides = [found.front, found.back] if isinstance(found, TwoSided) else [found]
        named = [document.kernels.get(each) if isinstance(each, str) else each for each in sides]
        if any(isinstance(each, Polariser | Retarder) for each in named):
            return True
    return False


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
    """Sentences about what polarises light otherwise in nature."""
    if not is_polarised(scene, kernels):
        return
    found = {kernel.WhichOneof("model") for kernel in kernels}
    for model, words in _NOT_AS_IN_NATURE.items():
        if model in found:
            yield f"$.kernels: {words}, other than in nature"
    if any(pane.HasField("measured") for kernel in kernels for pane in kernel.glazing.panes):
        yield "$.kernels: measured panes neither polarise nor depolarise light, other than in nature"
    scattering = [each for each in scene.media if not spectra.is_black(scene.spectra[each.scattering])]
    if any(not _has_matrix(medium.phase) for medium in scattering):
        yield (
            "$.media: media leave light unpolarised, other than in nature, but for molecules (phase function "
            '"rayleigh"), droplets ("mie") and tables with a "matrix"'
        )


def _has_matrix(phase: scene_pb2.PhaseFunction) -> bool:
    return phase.HasField("rayleigh") or bool(phase.tabulated.s12)
