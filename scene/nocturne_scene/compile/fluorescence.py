"""Fluorescent surfaces and dyes in media as messages; photons, and so energy, are balanced."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.fluorescence import Dye, Fluorophore, Reradiation
from nocturne_scene.document.kernels import Lambertian
from nocturne_scene.document.spectra import ConstantSpectrum, TableSpectrum
from nocturne_scene.document.textures import ColourTexture
from nocturne_scene.spectra.published import Floats

# Spectra are float32, and measured matrices have few digits.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class _Part:
    """A fluorophore, and the part of photons at the scene's wavelengths that it takes from other uses."""

    absorption: scene_pb2.Spectrum
    emission: scene_pb2.Spectrum
    taken: Floats


def fluoresces(kernels: Iterable[scene_pb2.Kernel], media: Iterable[scene_pb2.Medium]) -> bool:
    """Whether photons change their wavelengths at any surface or in any medium."""
    return any(kernel.HasField("fluorescent") for kernel in kernels) or any(
        medium.fluorophores for medium in media
    )


@dataclass(frozen=True)
class Dyes:
    """What the dyes of a medium do, 1/m at density 1."""

    absorption: Floats
    """At the grid of the wavelengths over which spectra are compiled."""
    null_collisions: Floats
    """Of photons from the sensor, at the same."""
    fluorophores: list[scene_pb2.Fluorescent.Fluorophore]


_COLLISIONS = 0.5
"""Of photons from the sensor, over what dyes would emit if light had the same power at all wavelengths: with
more of them a photon that passes is noisier, with less one that is emitted."""


def compile_dyes(workspace: Workspace, dyes: list[Dye], extinction: Floats) -> Dyes:
    """Return the dyes of a medium whose extinction without them is given, at the grid.

    Raises Unusable and its kin.
    """
    grid = workspace.spectral.grid()
    seen = workspace.wavelengths.grid()
    absorption, emitted = np.zeros_like(grid), np.zeros_like(grid)
    fluorophores = []
    for number, each in enumerate(dyes):
        try:
            (part,) = _dye(workspace, each)
        except Unusable as error:
            raise Unusable(str(error), f".fluorescence[{number}]{error.suffix}") from None
        absorption = absorption + spectra.evaluate(part.absorption, grid)
        if spectra.is_dark(part.absorption, workspace.wavelengths) or spectra.is_black(part.emission):
            continue
        excitation = float(np.trapezoid(part.taken * seen, seen))
        emitted = emitted + excitation * spectra.evaluate(part.emission, grid)
        fluorophores.append(
            scene_pb2.Fluorescent.Fluorophore(
                absorption=workspace.spectra.index_of(part.absorption),
                emission=workspace.spectra.index_of(part.emission),
            )
        )
    if not fluorophores:
        raise Unusable(
            f"nothing is both absorbed and emitted within {workspace.wavelengths}", ".fluorescence"
        )
    null = np.maximum(0.0, _COLLISIONS * emitted - extinction - absorption)
    return Dyes(absorption, null, fluorophores)


def compile_fluorescent(workspace: Workspace, kernel: Lambertian) -> scene_pb2.Fluorescent:
    """Return a diffuse surface that fluoresces. Raises Unusable and its kin."""
    if isinstance(kernel.reflectance, ColourTexture):
        raise Unusable("varies; expected a spectrum of a surface that fluoresces", ".reflectance")
    reflectance = workspace.reflectance(kernel.reflectance)
    grid = workspace.wavelengths.grid()
    taken = spectra.evaluate(workspace.spectra.messages[reflectance], grid)
    made = scene_pb2.Fluorescent(reflectance=scene_pb2.Colour(spectrum=reflectance))
    for number, each in enumerate(kernel.fluorescence):
        try:
            parts = _dye(workspace, each) if isinstance(each, Fluorophore) else _matrix(workspace, each)
        except Unusable as error:
            raise Unusable(str(error), f".fluorescence[{number}]{error.suffix}") from None
        for part in parts:
            taken = taken + part.taken
            if any(spectra.is_dark(each, workspace.wavelengths) for each in (part.absorption, part.emission)):
                continue
            made.fluorophores.add(
                absorption=workspace.spectra.index_of(part.absorption),
                emission=workspace.spectra.index_of(part.emission),
            )
    if np.any(taken > 1 + _ROUNDING):
        worst = int(np.argmax(taken))
        raise Unusable(
            f"of the photons at {grid[worst]:g} nm {taken[worst]:.6g} times as many are reflected or "
            "absorbed to be emitted; expected at most 1",
            ".fluorescence",
        )
    if not made.fluorophores:
        raise Unusable(
            f"nothing is both absorbed and emitted within {workspace.wavelengths}", ".fluorescence"
        )
    return made


def _dye(workspace: Workspace, dye: Fluorophore | Dye) -> list[_Part]:
    absorbing, emitting = workspace.spectrum(dye.absorption), workspace.spectrum(dye.emission)
    if not isinstance(absorbing, ConstantSpectrum | TableSpectrum) or absorbing.luminance is not None:
        wanted = "a number or a table" if isinstance(dye, Dye) else "a number or a table in [0, 1]"
        raise Unusable(f"is no part of the light; expected {wanted}", ".absorption")
    if not isinstance(emitting, TableSpectrum) or emitting.luminance is not None:
        raise Unusable("is no shape of an emission; expected a table", ".emission")
    knots = np.array(emitting.table, dtype=np.float64)
    photons = _times_wavelength(knots[:, 0], knots[:, 1])
    if not photons > 0:
        raise Unusable("emits nothing", ".emission")
    absorption = spectra.radiance(absorbing, workspace.spectral)
    shape = spectra.tabulated(emitting.table, "zero", workspace.spectral)
    emission = spectra.scaled_evenly(shape, dye.quantum_yield / photons)
    return [_Part(absorption, emission, spectra.evaluate(absorption, workspace.wavelengths.grid()))]


def _matrix(workspace: Workspace, matrix: Reradiation) -> list[_Part]:
    """One for each emitted wavelength, whose emission falls to its neighbours."""
    grid, within = workspace.wavelengths.grid(), workspace.spectral
    exciting, emitted = np.array(matrix.excitation_nm), np.array(matrix.emission_nm)
    values = np.array(matrix.values, dtype=np.float64)
    parts = []
    for number in range(len(emitted)):
        around = range(max(number - 1, 0), min(number + 2, len(emitted)))
        hat = [(float(emitted[each]), float(each == number)) for each in around]
        emission = spectra.tabulated(hat, "zero", within)
        excited = values[:, number] / exciting
        absorption = spectra.tabulated(
            list(zip(matrix.excitation_nm, excited.tolist(), strict=True)), "zero", within
        )
        photons = _times_wavelength(emitted[list(around)], np.array([each[1] for each in hat]))
        taken = np.interp(grid, exciting, excited, left=0.0, right=0.0) * photons
        parts.append(_Part(absorption, emission, taken))
    return parts


def _times_wavelength(wavelengths: Floats, values: Floats) -> float:
    """The integral of a piecewise linear function times wavelength: Simpson's rule is exact."""
    middle = 0.5 * (wavelengths[1:] + wavelengths[:-1])
    mean = 0.5 * (values[1:] + values[:-1])
    product = wavelengths * values
    return float(np.sum(np.diff(wavelengths) / 6 * (product[1:] + 4 * middle * mean + product[:-1])))
