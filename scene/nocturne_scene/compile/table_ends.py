"""Tables, formulas and colours that end within a scene's wavelengths, where these are not 360 to 830 nm."""

from collections.abc import Iterator

from pydantic import BaseModel

from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.indices import TableExtinction, TableIndex
from nocturne_scene.document.kernels import Measured
from nocturne_scene.document.luminaires import DistantDisc, EnvironmentMap
from nocturne_scene.document.media import Medium, TabulatedPhase
from nocturne_scene.document.node import NAMED
from nocturne_scene.document.problems import path
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.document.spectra import (
    ChartSpectrum,
    IlluminantSpectrum,
    RgbSpectrum,
    SolarSpectrum,
    TableSpectrum,
)
from nocturne_scene.document.textures import ColourTexture
from nocturne_scene.media import presets as media_presets
from nocturne_scene.spectra import indices, published, solar
from nocturne_scene.spectra.wavelength_range import VISIBLE

_Steps = tuple[str | int, ...]
_Ends = tuple[float, float]

_HELD = "the values at its ends are held beyond"
_DARK = "it is dark beyond"
_CONTINUED = f"its formula is continued to longer waves and down to {VISIBLE.first:g} nm, and held below"
_LIGHTS = frozenset({"radiance", "irradiance"})


def table_ends(workspace: Workspace) -> Iterator[str]:
    """Sentences with their places; none where the wavelengths are the usual ones."""
    seen = workspace.wavelengths
    if seen.is_usual:
        return
    for steps, value in _values(workspace):
        for ends, what, beyond in _known(steps, value):
            if seen.first < ends[0] or seen.last > ends[1]:
                yield (
                    f"{path(steps)}: {what} is known from {ends[0]:g} to {ends[1]:g} nm, and the scene is of "
                    f"{seen}; {beyond}"
                )


def _values(workspace: Workspace) -> Iterator[tuple[_Steps, object]]:
    """All objects and texts of the document that were used, with what leads to them."""
    waiting: list[tuple[_Steps, object]] = [((), workspace.document)]
    while waiting:
        steps, value = waiting.pop()
        yield steps, value
        inner: list[tuple[_Steps, object]] = []
        if isinstance(value, BaseModel):
            inner = [((*steps, name), getattr(value, name)) for name in type(value).model_fields]
        elif isinstance(value, dict):
            inner = [((*steps, name), entry) for name, entry in value.items()]
        elif isinstance(value, list) and value and isinstance(value[0], BaseModel):
            inner = [((*steps, index), entry) for index, entry in enumerate(value)]
        waiting += [each for each in reversed(inner) if _counts(workspace, each[0])]


def _counts(workspace: Workspace, steps: _Steps) -> bool:
    """A sensor's responses and fluorescence end where they end; of named entries those in use matter."""
    if steps[:2] == ("sensor", "responses") or "fluorescence" in steps:
        return False
    if len(steps) == 2 and steps[0] in NAMED and steps[0] != "groups":
        return workspace.is_used(str(steps[0]), str(steps[1]))
    return True


def _known(steps: _Steps, value: object) -> Iterator[tuple[_Ends, str, str]]:
    """A quantity, the wavelengths at which it is known, and its values beyond them."""
    usual = (VISIBLE.first, VISIBLE.last)
    match value:
        case TableSpectrum(outside=None):
            yield (value.table[0][0], value.table[-1][0]), "its table", _beyond(steps)
        case ChartSpectrum():
            wavelengths, _ = published.chart_patch(value.chart_patch)
            yield (float(wavelengths[0]), float(wavelengths[-1])), "a patch of the chart", _HELD
        case RgbSpectrum():
            yield usual, "a colour", _beyond(steps)
        case ColourTexture():
            yield usual, "a texture in colour", "the formulas of its colours are continued beyond"
        case IlluminantSpectrum() if value.illuminant not in ("A", "E"):
            wavelengths, _ = published.illuminant(value.illuminant)
            yield (float(wavelengths[0]), float(wavelengths[-1])), "the illuminant", _DARK
        case SolarSpectrum():
            yield (solar.FIRST, solar.LAST), "sunlight by ASTM G173", _DARK
        case DistantDisc(sun=True):
            yield (solar.FIRST, solar.LAST), "the Sun by ASTM G173", _DARK
        case EnvironmentMap() | StandardSky() | WeatherSky():
            yield usual, "the light of a picture or of a sky by formulas", _DARK
        case TableIndex() | TableExtinction():
            yield (value.table[0][0], value.table[-1][0]), "its table", _HELD
        case TabulatedPhase():
            yield (value.wavelengths[0], value.wavelengths[-1]), "its table", _HELD
        case Measured(format="merl"):
            yield usual, "a measurement in red, green and blue", _HELD
        case Medium(preset=str(name)):
            yield from _of_preset(name)
        case str(name) if steps and steps[-1] in ("index", "n"):
            yield from _of_index(name)
    if steps and steps[-1] == "ozone" and value is not None:
        yield media_presets.OZONE_ENDS, "ozone", "there is none beyond"


def _beyond(steps: _Steps) -> str:
    if _LIGHTS.intersection(steps):
        return _DARK
    if steps[0] == "spectra":
        return f"{_HELD}, or {_DARK} where it is light"
    return _HELD


def _of_index(name: str) -> Iterator[tuple[_Ends, str, str]]:
    if name in indices.dielectrics():
        yield indices.dielectric(name).valid, f'the index of "{name}"', _CONTINUED
    elif name in indices.metals():
        yield indices.metal(name).valid, f'the index of "{name}"', _HELD


def _of_preset(name: str) -> Iterator[tuple[_Ends, str, str]]:
    ends = media_presets.ends(name)
    if ends is not None:
        yield ends, f'"{name}"', _HELD
    elif name in media_presets.droplets():
        yield from _of_index("water")
