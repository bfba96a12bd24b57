"""What the pixels of each kind of sensor measure, and in which unit."""

from collections.abc import Sequence
from dataclasses import dataclass

from nocturne.v1 import scene_pb2

from nocturne_scene.spectra.named_responses import RESPONSES, NamedResponse


@dataclass(frozen=True)
class Quantity:
    """Of Y, and of a sensor's further responses."""

    name: str
    unit: str
    """Of Y, in ASCII."""
    response_unit: str
    """Of a further response without another unit: the integral of spectral radiance (irradiance,
    intensity) times the response, over wavelength."""

    @property
    def has_colour(self) -> bool:
        """Whether X, Y and Z are those of an observer, and not one number three times."""
        return self in _PHOTOMETRIC or not self.name

    @property
    def geometry(self) -> str:
        """What of an amount this is: "m-2 sr-1", "m-2" or "sr-1"."""
        return self.response_unit.removeprefix("W ")

    def of_channel(self, name: str, names: Sequence[str]) -> tuple[str, str]:
        """What a channel is, and its unit; `names` are those of all channels: X, Y, Z, further responses."""
        if name == "Y":
            return self.name or "Y", self.unit
        if names.index(name) < len("XYZ"):
            return name, self.unit
        if name in RESPONSES and self.response_unit:
            return name, _unit(RESPONSES[name], self.geometry)
        return name, self.response_unit


LUMINANCE = Quantity("luminance", "cd/m2", "W m-2 sr-1")
ILLUMINANCE = Quantity("illuminance", "lx", "W m-2")
INTENSITY = Quantity("luminous intensity", "cd", "W sr-1")

_UNKNOWN = Quantity("", "", "")
_RADIOMETRIC = {LUMINANCE: "radiance", ILLUMINANCE: "irradiance", INTENSITY: "radiant intensity"}
_OF_PHOTONS = {LUMINANCE: "radiance", ILLUMINANCE: "flux density", INTENSITY: "intensity"}


def _unit(response: NamedResponse, geometry: str) -> str:
    """As people write it: W m-2 sr-1, umol m-2 s-1."""
    amount, _, per_time = response.amount.partition(" ")
    return " ".join(part for part in (amount, geometry, per_time) if part)


def measured_by(photometric: Quantity, response: str) -> Quantity:
    """What takes the place of a photometric quantity where a sensor measures by a response's name."""
    found = RESPONSES[response]
    words = found.quantity.strip() if found.quantity else response
    kind = _OF_PHOTONS[photometric] if found.amount.startswith("umol") else _RADIOMETRIC[photometric]
    name = f"{words} {kind}".strip()
    return Quantity(name, _unit(found, photometric.geometry), photometric.response_unit)


_PHOTOMETRIC = (LUMINANCE, ILLUMINANCE, INTENSITY)
_ALL = (*_PHOTOMETRIC, *(measured_by(each, response) for each in _PHOTOMETRIC for response in RESPONSES))
_BY_NAME = {each.name: each for each in _ALL}


def photometric_quantity_of(model: scene_pb2.SensorModel.ValueType) -> Quantity:
    """What a sensor measures by the CIE's observer."""
    match model:
        case scene_pb2.SENSOR_MODEL_PLANE | scene_pb2.SENSOR_MODEL_METERS:
            return ILLUMINANCE
        case scene_pb2.SENSOR_MODEL_INTENSITY:
            return INTENSITY
        case _:
            return LUMINANCE


def quantity_of(sensor: scene_pb2.Sensor) -> Quantity:
    """What a compiled scene's sensor measures."""
    if sensor.HasField("quantity"):
        told = sensor.quantity
        return Quantity(told.name, told.unit, told.response_unit)
    return photometric_quantity_of(sensor.model)


def quantity_named(name: str) -> Quantity:
    """By its name; without a unit where it is not known, as of images from before it was kept."""
    return _BY_NAME.get(name, _UNKNOWN)
