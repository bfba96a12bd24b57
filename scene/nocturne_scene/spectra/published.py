"""Numbers that others measured or agreed on: observers, illuminants, the colour chart. The only user of
colour-science.

The package's own files in `scene/data` are read here too.
"""

import tomllib
import warnings
from collections.abc import Callable, Mapping
from functools import lru_cache
from importlib import metadata, resources
from types import ModuleType
from typing import Any

import numpy as np
import platformdirs

from nocturne_scene.replacing import replacing
from nocturne_scene.spectra.constants import BOLTZMANN as BOLTZMANN
from nocturne_scene.spectra.constants import FIRST as FIRST
from nocturne_scene.spectra.constants import LAST as LAST
from nocturne_scene.spectra.constants import LIGHT_SPEED as LIGHT_SPEED
from nocturne_scene.spectra.constants import PLANCK as PLANCK
from nocturne_scene.spectra.constants import STEP as STEP
from nocturne_scene.spectra.constants import Floats as Floats

# lm/W. CIE 018:2019: the luminous efficacy that makes Y the luminance in cd/m2.
MAX_LUMINOUS_EFFICACY = 683.0

# IEC 61966-2-1: the printed matrices between XYZ (Y of white = 1) and linear sRGB, and Y of red, green
# and blue.
XYZ_TO_SRGB = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
SRGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
SRGB_LUMINANCE = (0.2126, 0.7152, 0.0722)

# Name in documents, and in colour-science.
OBSERVERS: Mapping[str, str] = {
    "CIE 1931 2 degree": "CIE 1931 2 Degree Standard Observer",
    "CIE 1964 10 degree": "CIE 1964 10 Degree Standard Observer",
}

_DAYLIGHTS = ("D50", "D55", "D65", "D75")

ILLUMINANTS: tuple[str, ...] = (
    *("A", "C", *_DAYLIGHTS, "E"),
    *(f"FL{number}" for number in range(1, 13)),
    *(f"FL3.{number}" for number in range(1, 16)),
    *(f"HP{number}" for number in range(1, 6)),
    *(f"LED-B{number}" for number in range(1, 6)),
    *("LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"),
)

# As they lie on the chart, from the top left.
CHART_PATCHES: Mapping[str, str] = {
    "dark skin": "dark skin",
    "light skin": "light skin",
    "blue sky": "blue sky",
    "foliage": "foliage",
    "blue flower": "blue flower",
    "bluish green": "bluish green",
    "orange": "orange",
    "purplish blue": "purplish blue",
    "moderate red": "moderate red",
    "purple": "purple",
    "yellow green": "yellow green",
    "orange yellow": "orange yellow",
    "blue": "blue",
    "green": "green",
    "red": "red",
    "yellow": "yellow",
    "magenta": "magenta",
    "cyan": "cyan",
    "white": "white 9.5 (.05 D)",
    "neutral 8": "neutral 8 (.23 D)",
    "neutral 6.5": "neutral 6.5 (.44 D)",
    "neutral 5": "neutral 5 (.70 D)",
    "neutral 3.5": "neutral 3.5 (1.05 D)",
    "black": "black 2 (1.5 D)",
}


@lru_cache(maxsize=1)
def _colour() -> ModuleType:
    """Import colour-science late, as that takes a second; nobody here needs its remark about Matplotlib."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message='"Matplotlib" related API features are not available')
        import colour
    return colour


def _kept(name: str, read: Callable[[], Floats]) -> Floats:
    """Return a table of colour-science from the user's cache, or by `read`, and keep it there.

    Importing colour-science would take most of a short command's time.
    """
    version = metadata.version("colour-science")
    place = platformdirs.user_cache_path("nocturne") / f"colour-{version}-{name}.npy"
    try:
        return np.asarray(np.load(place), dtype=np.float64)
    except (OSError, ValueError, EOFError):
        table = read()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with replacing(place) as unfinished:
            np.save(unfinished, table)
    except OSError:
        pass  # nowhere to keep it: read again next time
    return table


def _spectrum(found: Any) -> Floats:
    """A row of wavelengths and a row of values."""
    return np.stack([np.asarray(found.wavelengths), np.asarray(found.values)])


def visible_wavelengths() -> Floats:
    """Return FIRST to LAST in steps of STEP, nm: 471 numbers."""
    return np.arange(FIRST, LAST + STEP / 2, STEP)


@lru_cache(maxsize=len(OBSERVERS))
def observer(name: str) -> Floats:
    """Return colour matching functions, shape (471, 3), at `visible_wavelengths`; `name` is a key of
    OBSERVERS.

    CIE 018:2019 and CIE 015:2018.
    """

    def read() -> Floats:
        found = _colour().MSDS_CMFS[OBSERVERS[name]]
        visible = (found.wavelengths >= FIRST) & (found.wavelengths <= LAST)
        return np.asarray(found.values[visible], dtype=np.float64)

    return _kept(f"observer-{name}", read)


@lru_cache(maxsize=2 * len(ILLUMINANTS))
def illuminant(name: str, first: float = FIRST, last: float = LAST) -> tuple[Floats, Floats]:
    """Return wavelengths in nm and the relative spectrum there, linear in between; `name` is one of
    ILLUMINANTS.

    A is CIE 015:2018, equation 4.1, each nm from `first` to `last`; E is even there. The others are its
    tables, each 5 nm, as colour-science has them: to 780 nm. Beyond, the daylights are held to 830 nm (its
    section 7.2.3); the others are dark.
    """
    if name == "E":
        return np.array([first, last]), np.ones(2)
    if name == "A":
        wavelengths = np.arange(first, last + STEP / 2, STEP)
        return wavelengths, _illuminant_a(wavelengths)
    wavelengths, values = _kept(f"illuminant-{name}", lambda: _spectrum(_colour().SDS_ILLUMINANTS[name]))
    if name not in _DAYLIGHTS:
        return wavelengths, values
    beyond = np.arange(wavelengths[-1] + 5.0, LAST + 2.5, 5.0)
    return np.append(wavelengths, beyond), np.append(values, np.full(len(beyond), values[-1]))


def _illuminant_a(wavelengths: Floats) -> Floats:
    c2 = 1.435e7  # nm K, as when A was defined
    at_560 = np.expm1(c2 / (2848 * 560))
    return np.asarray(100 * (560 / wavelengths) ** 5 * at_560 / np.expm1(c2 / (2848 * wavelengths)))


def planck(temperature: float, wavelengths: Floats) -> Floats:
    """Return the spectral radiance of a black body in vacuum, W m-2 sr-1 nm-1, at wavelengths in nm.

    Temperature in K.
    """
    metres = wavelengths * 1e-9
    exponent = PLANCK * LIGHT_SPEED / (metres * BOLTZMANN * temperature)
    # exp(-x) / (1 - exp(-x)) instead of 1 / (exp(x) - 1): no overflow for a cold body.
    per_metre = 2 * PLANCK * LIGHT_SPEED**2 / metres**5 * np.exp(-exponent) / -np.expm1(-exponent)
    return np.asarray(per_metre * 1e-9)


@lru_cache(maxsize=len(CHART_PATCHES))
def chart_patch(name: str) -> tuple[Floats, Floats]:
    """Return wavelengths (380 to 730 nm, each 10 nm) and reflectance of a patch of the 24-patch colour chart.

    `name` is a key of CHART_PATCHES. Averages over 30 charts: D. Pascale, BabelColor, 2012, in
    colour-science.
    """

    def read() -> Floats:
        return _spectrum(_colour().SDS_COLOURCHECKERS["BabelColor Average"][CHART_PATCHES[name]])

    wavelengths, values = _kept(f"patch-{name}", read)
    return wavelengths, values


@lru_cache(maxsize=1)
def srgb_basis() -> tuple[Floats, Floats]:
    """Return wavelengths (380 to 780 nm, each 5 nm) and shape (81, 3): reflectances of red, green and blue.

    They add up to 1, and under D65 any sum of them has the linear sRGB of its weights: I. Mallett and
    C. Yuksel, "Spectral primary decomposition for rendering with sRGB reflectance", EGSR 2019, in
    colour-science.
    """

    def read() -> Floats:
        found = _colour().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
        return np.column_stack([found.wavelengths, found.values])

    table = _kept("srgb-basis", read)
    values = np.ascontiguousarray(table[:, 1:])
    return np.ascontiguousarray(table[:, 0]), values / values.sum(axis=1, keepdims=True)


@lru_cache(maxsize=8)
def data_file(name: str) -> dict[str, Any]:
    """Read a TOML file of `scene/data`."""
    return tomllib.loads(resources.files("nocturne_scene.data").joinpath(name).read_text("utf-8"))


def data_bytes(name: str) -> bytes:
    """Read a binary file of `scene/data`."""
    return resources.files("nocturne_scene.data").joinpath(name).read_bytes()


COLOUR_RANGE = (380, 780)
"""nm, both ends in: what colour rendering and alpha-opic quantities are defined over (CIE 13.3, CIE 224, CIE
S 026)."""


def colour_wavelengths() -> Floats:
    """COLOUR_RANGE, each nm: 401 numbers."""
    return np.arange(COLOUR_RANGE[0], COLOUR_RANGE[1] + 1.0)


@lru_cache(maxsize=1)
def test_colours() -> Floats:
    """Reflectances of the 14 test colours of CIE 13.3-1995, shape (401, 14), at `colour_wavelengths`; its
    tables are each 5 nm, straight in between."""

    def read() -> Floats:
        found = _colour().quality.SDS_TCS["CIE 1995"].values()
        columns = [np.interp(colour_wavelengths(), each.wavelengths, each.values) for each in found]
        return np.stack(columns, axis=-1)

    return _kept("test-colours", read)


@lru_cache(maxsize=1)
def colour_evaluation_samples() -> Floats:
    """Reflectances of the 99 samples of CIE 224:2017 and ANSI/IES TM-30-20, shape (401, 99), at
    `colour_wavelengths`."""

    def read() -> Floats:
        colour = _colour()
        shape = colour.SpectralShape(*COLOUR_RANGE, 1)
        return np.asarray(colour.quality.cfi2017.load_TCS_CIE2017(shape).values, dtype=np.float64)

    return _kept("colour-evaluation-samples", read)


@lru_cache(maxsize=1)
def daylight_components() -> Floats:
    """S0, S1, S2 of CIE 015:2018, table 6, shape (401, 3), at `colour_wavelengths`; each 5 nm, straight in
    between."""

    def read() -> Floats:
        found = _colour().colorimetry.SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES
        columns = [
            np.interp(colour_wavelengths(), found[name].wavelengths, found[name].values)
            for name in ("S0", "S1", "S2")
        ]
        return np.stack(columns, axis=-1)

    return _kept("daylight-components", read)


ALPHA_OPIC = ("S-cone-opic", "M-cone-opic", "L-cone-opic", "rhodopic", "melanopic")
"""The responses of CIE S 026/E:2018."""


@lru_cache(maxsize=1)
def alpha_opic_spectra() -> Floats:
    """Action spectra of ALPHA_OPIC, shape (401, 5), at `colour_wavelengths`; largest 1.

    Cones: Stockman and Sharpe's fundamentals for 10 degrees, CIE 170-1:2006. Rods: CIE 1951. Melanopsin: the
    standard's own table. Together these are the tables of CIE S 026/E:2018.
    """

    def read() -> Floats:
        colour, wavelengths = _colour(), colour_wavelengths()
        cones = colour.MSDS_CMFS["Stockman & Sharpe 10 Degree Cone Fundamentals"]
        rods = colour.SDS_LEFS["CIE 1951 Scotopic Standard Observer"]
        long, medium, short = (
            np.interp(wavelengths, cones.wavelengths, each, left=0.0, right=0.0) for each in cones.values.T
        )
        rod = np.interp(wavelengths, rods.wavelengths, rods.values)
        return np.stack([short, medium, long, rod], axis=-1)

    melanopic = np.array(data_file("action_spectra.toml")["melanopic"])
    return np.column_stack([_kept("cones-and-rods", read), melanopic])
