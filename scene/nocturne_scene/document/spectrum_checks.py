"""Whether a spectrum is fit for its use."""

from collections.abc import Iterator

from nocturne_scene.document import bounds
from nocturne_scene.document.spectra import (
    BlackbodySpectrum,
    ChartSpectrum,
    ConstantSpectrum,
    IlluminantSpectrum,
    LineSpectrum,
    RgbSpectrum,
    SolarSpectrum,
    Spectrum,
    TableSpectrum,
)
from nocturne_scene.errors import Problem

Reference = str | float | Spectrum

_LIGHTS = (BlackbodySpectrum, IlluminantSpectrum, SolarSpectrum, LineSpectrum)


def reflectance_problems(spectrum: Spectrum, reference: Reference, place: str) -> Iterator[Problem]:
    """Yield why a spectrum can't be a reflectance or transmittance."""
    whose = _whose(reference)
    if isinstance(spectrum, _LIGHTS):
        yield Problem(
            place, f"{whose}a radiance; expected a reflectance: a constant or a table with values in [0, 1]"
        )
        return
    if isinstance(spectrum, ChartSpectrum):
        return
    if spectrum.luminance is not None:
        yield Problem(
            place, f"{whose}scaled to a luminance, which only a radiance can be; a reflectance has none"
        )
    if isinstance(spectrum, RgbSpectrum):
        return
    for inside, value in _values(spectrum, is_bare=isinstance(reference, int | float)):
        if value > 1:
            within = f" at {inside}" if isinstance(reference, str) else ""
            at = place if isinstance(reference, str) else place + inside
            yield Problem(at, f"{whose}{value:g}{within}; a reflectance lies in [0, 1]")


def absorption_problems(spectrum: Spectrum, reference: Reference, place: str) -> Iterator[Problem]:
    """Yield why a spectrum can't be an absorption coefficient."""
    if not isinstance(spectrum, ConstantSpectrum | TableSpectrum) or spectrum.luminance is not None:
        yield Problem(
            place,
            f"{_whose(reference)}no absorption coefficient; expected a constant or a table, in 1/m, without "
            "luminance",
        )


def coefficient_problems(spectrum: Spectrum, reference: Reference, place: str) -> Iterator[Problem]:
    """Yield why a spectrum can't be a medium's coefficient."""
    if isinstance(spectrum, _LIGHTS):
        yield Problem(
            place,
            f"{_whose(reference)}a radiance; expected a coefficient in 1/m: a number, a table, or a colour",
        )
    elif not isinstance(spectrum, ChartSpectrum) and spectrum.luminance is not None:
        yield Problem(
            place, f"{_whose(reference)}scaled to a luminance, which only a radiance can be; leave it out"
        )
    elif isinstance(spectrum, ConstantSpectrum | TableSpectrum):
        for inside, value in _values(spectrum, is_bare=isinstance(reference, int | float)):
            if value > bounds.COEFFICIENT:
                at = place if isinstance(reference, str) else place + inside
                yield Problem(
                    at, f"{_whose(reference)}{value:g}; expected at most {bounds.COEFFICIENT:g} 1/m"
                )


def depolarisation_problems(spectrum: Spectrum, reference: Reference, place: str) -> Iterator[Problem]:
    """Yield why a spectrum can't be a depolarisation ratio."""
    if not isinstance(spectrum, ConstantSpectrum | TableSpectrum) or spectrum.luminance is not None:
        yield Problem(
            place, f"{_whose(reference)}no depolarisation ratio; expected a number or a table in [0, 1)"
        )
        return
    for inside, value in _values(spectrum, is_bare=isinstance(reference, int | float)):
        if value >= 1:
            at = place if isinstance(reference, str) else place + inside
            yield Problem(at, f"{_whose(reference)}{value:g}; a depolarisation ratio lies in [0, 1)")


def radiance_problems(
    spectrum: Spectrum, reference: Reference, place: str, *, may_be_relative: bool = False
) -> Iterator[Problem]:
    """Yield why a spectrum can't be a radiance; `may_be_relative`: only its shape counts."""
    if isinstance(spectrum, ChartSpectrum):
        yield Problem(place, f"{_whose(reference)}a reflectance; expected a radiance")
    elif may_be_relative:
        return
    elif isinstance(spectrum, IlluminantSpectrum) and spectrum.luminance is None:
        yield Problem(
            place,
            f"{_whose(reference)}a relative spectrum without a size; add its luminance in cd/m2, such as "
            f'{{"illuminant": "{spectrum.illuminant}", "luminance": 100}}',
        )
    elif isinstance(spectrum, RgbSpectrum) and spectrum.luminance is None:
        yield Problem(
            place,
            f"{_whose(reference)}a colour without a size; add its luminance in cd/m2, such as "
            f'{{"rgb": {list(spectrum.rgb)}, "luminance": 100}}',
        )


def _whose(reference: Reference) -> str:
    return f'spectrum "{reference}" is ' if isinstance(reference, str) else "is "


def _values(spectrum: ConstantSpectrum | TableSpectrum, *, is_bare: bool) -> Iterator[tuple[str, float]]:
    """Yield each value with the path to it inside the spectrum."""
    if isinstance(spectrum, ConstantSpectrum):
        yield "" if is_bare else ".constant", spectrum.constant
        return
    for index, (_, value) in enumerate(spectrum.table):
        yield f".table[{index}][1]", value
