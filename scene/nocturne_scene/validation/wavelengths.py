"""Ultraviolet and near infrared: black bodies, sunlight, lines weighed by published responses, furnaces, and
air and ozone before the Sun."""

from collections.abc import Iterator
from itertools import pairwise
from math import exp, log, pi

import numpy as np

from nocturne_scene.spectra import solar
from nocturne_scene.spectra.constants import AVOGADRO, BOLTZMANN, LIGHT_SPEED, PLANCK
from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import BLACK, Document, film, furnace, quad, sphere

_PLANCK = (
    "Planck's integral by the series of S. L. Chang and K. T. Rhee, Int. Comm. Heat Mass Transfer 11, 1984"
)
_G173 = "ASTM G173-03, trapezoid rule over its table"
_SQUARE = "inverse-square law, E = P / (4 pi d^2)"
_FURNACE = "energy balance at each wavelength: the integral of e / (1 - albedo)"
_PHOTONS = "l / (h c N_A), SI 2019"
_ERYTHEMAL = "ISO/CIE 17166:2019"
_ACTINIC = "ICNIRP, Health Physics 87, 2004, table 1"
_RAYLEIGH = "B. A. Bodhaine et al., J. Atmos. Oceanic Technol. 16, 1999, equation 30"
_OZONE = "CCQM.O3.2019: 1.1329e-17 cm2 at 253.65 nm and 296 K; colder by less than 1 %"

_MOLE = PLANCK * LIGHT_SPEED * AVOGADRO


def scenes() -> Iterator[Scene]:
    """Readings in W, umol s-1 and weighed watts."""
    yield from _black_bodies()
    yield from _sunlight()
    yield from _lines()
    yield from _furnaces()
    yield from _air()


def planck_fraction(metre_kelvin: float) -> float:
    """Part of a black body's radiance below a wavelength; wavelength times temperature is given."""
    x = PLANCK * LIGHT_SPEED / BOLTZMANN / metre_kelvin
    terms = (exp(-n * x) * (x**3 / n + 3 * x**2 / n**2 + 6 * x / n**3 + 6 / n**4) for n in range(1, 300))
    return 15.0 / pi**4 * sum(terms)


def band_radiance(kelvin: float, first: float, last: float) -> float:
    """Of a black body from one wavelength to another, W m-2 sr-1."""
    constant = 2.0 * pi**4 * BOLTZMANN**4 / 15.0 / PLANCK**3 / LIGHT_SPEED**2
    low, high = (planck_fraction(nm * 1e-9 * kelvin) for nm in (first, last))
    return constant * kelvin**4 * (high - low)


def _black_bodies() -> Iterator[Scene]:
    """In bands of the whole range, and by the range itself."""
    for kelvin in (2856.0, 5772.0):
        for first, last in pairwise((200, 280, 315, 400, 700, 1100, 1700, 2500)):
            # Each nm with straight lines between: below 300 nm the curve bends by more than a part in 1000.
            if kelvin > 5000 or first >= 315:
                name = f"black body of {kelvin:g} K, {first} to {last} nm, W m-2 sr-1"
                truth = band_radiance(kelvin, first, last)
                document = _lamp({"blackbody": kelvin}, first, last)
                yield Scene(document, (Value(name, truth, _PLANCK, "Y"),), 2**14)


def _sunlight() -> Iterator[Scene]:
    """On a film that faces it."""
    for name in solar.NAMES:
        wavelengths, values = solar.table(name)
        for first, last in ((280, 400), (400, 700), (280, 2500)):
            inside = (wavelengths >= first) & (wavelengths <= last)
            at, power = wavelengths[inside], values[inside]
            truth = float(np.trapezoid(power, at))
            document = _towards_sun({"solar": name}, first, last)
            found = [Value(f"{name} sunlight, {first} to {last} nm, W m-2", truth, _G173, "Y")]
            if (first, last) == (400, 700):
                photons = float(np.trapezoid(power * at, at)) * 1e-9 / _MOLE * 1e6
                document["sensor"]["named_responses"] = ["PAR"]
                found.append(Value(f"{name} sunlight, PPFD, umol m-2 s-1", photons, _PHOTONS, "PAR"))
            yield Scene(document, tuple(found), 2**14)


def _lines() -> Iterator[Scene]:
    """Of 10 W in all directions, 2 m away: the lamp's line is as narrow as lines are."""
    irradiance = 10.0 / (4.0 * pi * 4.0)
    cases = (
        (254.0, "actinic", 0.5, _ACTINIC),
        (270.0, "actinic", 1.0, _ACTINIC),
        (300.0, "actinic", 0.3, _ACTINIC),
        (270.0, "erythemal", 1.0, _ERYTHEMAL),
        (311.0, "erythemal", 10.0 ** (0.094 * (298.0 - 311.0)), _ERYTHEMAL),
        (350.0, "erythemal", 10.0 ** (0.015 * (140.0 - 350.0)), _ERYTHEMAL),
        (450.0, "PAR", 450e-9 / _MOLE * 1e6, _PHOTONS),
        (660.0, "PAR", 660e-9 / _MOLE * 1e6, _PHOTONS),
        (940.0, "photons", 940e-9 / _MOLE * 1e6, _PHOTONS),
        (1550.0, "radiant", 1.0, _SQUARE),
    )
    for nm, response, weight, source in cases:
        lamp = {
            "shape": sphere([0, 0, 2], 0.005),
            "kernel": BLACK,
            "luminaire": {"watts": 10.0, "radiance": {"lines": [{"nm": nm, "power": 1.0, "width": 0.01}]}},
        }
        sensor = film([0, 0, 0], [0, 0, 1], 1e-5, measures=response)
        name = f"line at {nm:g} nm, {response}"
        yield _scene(name, source, weight * irradiance, sensor, [lamp], 200, 1600, samples=2**15)


def _furnaces() -> Iterator[Scene]:
    """Albedo that rises along the range."""
    for first, last in ((200, 280), (280, 400), (1000, 2500)):
        for low, high in ((0.5, 0.5), (0.2, 0.9)):
            document = furnace(low, 2.0)
            document["spectra"]["wall"] = {"table": [[first, low], [last, high]]}
            document["sensor"]["measures"] = "radiant"
            slope = (high - low) / (last - first)
            truth = 2.0 * ((last - first) / (1 - low) if not slope else log((1 - low) / (1 - high)) / slope)
            name = f"furnace, {first} to {last} nm, albedo {low:g} to {high:g}, W m-2 sr-1"
            document["wavelengths"] = {"first": first, "last": last}
            yield Scene(document, (Value(name, truth, _FURNACE, "Y"),))


def _air() -> Iterator[Scene]:
    """A narrow look at the Sun, whose light is a line, straight up: what of it comes through."""
    for nm in (250, 300, 350, 400, 1000):
        squared = (nm * 1e-3) ** 2
        depth = 0.0021520 * (1.0455996 - 341.29061 / squared - 0.90230850 * squared)
        depth /= 1.0 + 0.0027059889 / squared - 85.968563 * squared
        document = _through_air(float(nm), {"air": {}})
        value = Value(f"clean air at {nm} nm, straight transmittance", exp(-depth), _RAYLEIGH, "Y")
        yield Scene(document, (value,))
    for dobson_units in (1.0, 5.0):
        depth = dobson_units * 2.686780111e16 * 1.1329e-17
        document = _through_air(253.65, {"air": None, "ozone": {"dobson_units": dobson_units}})
        name = f"{dobson_units:g} DU of ozone at 253.65 nm, straight transmittance"
        # So few samples that the noise is more than what temperature may change.
        yield Scene(document, (Value(name, exp(-depth), _OZONE, "Y"),), 2**13)


def _lamp(radiance: Document, first: int, last: int) -> Document:
    """It fills the image."""
    camera = {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 0.1}
    surface = {
        "shape": quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]),
        "kernel": BLACK,
        "luminaire": {"radiance": radiance},
    }
    return _document({**camera, "measures": "radiant"}, [surface], first, last)


def _towards_sun(irradiance: Document, first: int, last: int) -> Document:
    """A film, and something black behind it."""
    sensor = film([0, 0, 0], [0, 0, 1], 1.0, measures="radiant")
    disc = {"direction": [0, 0, 1], "angular_diameter_degrees": 0.01, "irradiance": irradiance}
    body = {"shape": sphere([0, 0, -3], 1.0), "kernel": BLACK}
    return _document(sensor, [body], first, last) | {"distant": [disc]}


def _through_air(nm: float, atmosphere: Document) -> Document:
    """Of a disc of radiance 1 W m-2 sr-1, over black ground."""
    sensor = {
        "type": "radiance_meter",
        "position": [0, 0, 0.01],
        "look_at": [0, 0, 1],
        "up": [0, 1, 0],
        "diameter": 1e-3,
        "cone_degrees": 0.005,
        "measures": "radiant",
    }
    line = {"lines": [{"nm": nm, "power": 1.0, "width": 0.01}]}
    disc = {"direction": [0, 0, 1], "angular_diameter_degrees": 0.01, "radiance": line}
    air = {"up": [0, 0, 1], "ground_reflectance": 0.0, **atmosphere}
    return _document(sensor, [], 200, 1100) | {"distant": [disc], "atmosphere": air}


def _document(sensor: Document, surfaces: list[Document], first: int, last: int) -> Document:
    return {
        "nocturne": 1,
        "wavelengths": {"first": first, "last": last},
        "sensor": sensor,
        "surfaces": surfaces,
    }


def _scene(
    name: str,
    source: str,
    truth: float,
    sensor: Document,
    surfaces: list[Document],
    first: int,
    last: int,
    samples: int,
) -> Scene:
    return Scene(_document(sensor, surfaces, first, last), (Value(name, truth, source, "Y"),), samples)
