"""Checks that need the whole document: what a spectrum is used for, and whether there is light at all."""

from collections.abc import Iterator

from nocturne_coordinator.errors import Problem
from nocturne_coordinator.scene.model import Lambertian, SceneDocument
from nocturne_coordinator.scene.problems import path
from nocturne_coordinator.scene.spectrum_model import (
    BlackbodySpectrum,
    ConstantSpectrum,
    IlluminantSpectrum,
    Spectrum,
    TableSpectrum,
)


def whole_document_problems(document: SceneDocument) -> Iterator[Problem]:
    """Yield what the schema alone cannot see; all names are known to exist."""
    for name, kernel in document.kernels.items():
        yield from _kernel_problems(document, kernel, path(("kernels", name)))
    for index, surface in enumerate(document.surfaces):
        place = path(("surfaces", index))
        if isinstance(surface.kernel, Lambertian):
            yield from _kernel_problems(document, surface.kernel, f"{place}.kernel")
        if surface.luminaire is not None:
            yield from _radiance_problems(document, surface.luminaire.radiance, f"{place}.luminaire.radiance")
    if all(surface.luminaire is None for surface in document.surfaces):
        yield Problem(
            "$.surfaces",
            "no surface has a luminaire, so the image would be black; give at least one a luminaire",
        )


def resolve_spectrum(document: SceneDocument, reference: str | float | Spectrum) -> Spectrum:
    """Return the spectrum that a reference or bare number stands for."""
    found = document.spectra[reference] if isinstance(reference, str) else reference
    return ConstantSpectrum(constant=found) if isinstance(found, int | float) else found


def _kernel_problems(document: SceneDocument, kernel: Lambertian, place: str) -> Iterator[Problem]:
    spectrum = resolve_spectrum(document, kernel.reflectance)
    place, whose = f"{place}.reflectance", _whose(kernel.reflectance)
    if isinstance(spectrum, BlackbodySpectrum | IlluminantSpectrum):
        yield Problem(
            place, f"{whose}a radiance; expected a reflectance: a constant or a table with values in [0, 1]"
        )
        return
    if spectrum.luminance is not None:
        yield Problem(
            place, f"{whose}scaled to a luminance, which only a radiance can be; a reflectance has none"
        )
    for inside, value in _values(spectrum, is_bare=isinstance(kernel.reflectance, int | float)):
        if value > 1:
            within = f" at {inside}" if isinstance(kernel.reflectance, str) else ""
            at = place if isinstance(kernel.reflectance, str) else place + inside
            yield Problem(at, f"{whose}{value:g}{within}; a reflectance lies in [0, 1]")


def _radiance_problems(
    document: SceneDocument, radiance: str | float | Spectrum, place: str
) -> Iterator[Problem]:
    spectrum = resolve_spectrum(document, radiance)
    if isinstance(spectrum, IlluminantSpectrum) and spectrum.luminance is None:
        yield Problem(
            place,
            f"{_whose(radiance)}a relative spectrum without a size; add its luminance in cd/m2, such as "
            f'{{"illuminant": "{spectrum.illuminant}", "luminance": 100}}',
        )


def _whose(reference: str | float | Spectrum) -> str:
    return f'spectrum "{reference}" is ' if isinstance(reference, str) else "is "


def _values(spectrum: ConstantSpectrum | TableSpectrum, *, is_bare: bool) -> Iterator[tuple[str, float]]:
    """Yield each value with the path to it inside the spectrum."""
    if isinstance(spectrum, ConstantSpectrum):
        yield "" if is_bare else ".constant", spectrum.constant
        return
    for index, (_, value) in enumerate(spectrum.table):
        yield f".table[{index}][1]", value
