"""What the pixels of each kind of sensor measure, and in which unit."""

from collections.abc import Sequence
from dataclasses import dataclass

from nocturne.v1 import scene_pb2


@dataclass(frozen=True)
class Quantity:
    """Of Y, and of a sensor's further responses."""

    name: str
    unit: str
    """Of Y, in ASCII."""
    response_unit: str
    """Of a further response without another unit: the integral of spectral radiance (irradiance,
    intensity) times the response, over wavelength."""

    def of_channel(self, name: str, names: Sequence[str]) -> tuple[str, str]:
        """What a channel is, and its unit; `names` are those of all channels: X, Y, Z, further responses."""
        if name == "Y":
            return self.name or "Y", self.unit
        return name, self.unit if names.index(name) < len("XYZ") else self.response_unit


LUMINANCE = Quantity("luminance", "cd/m2", "W m-2 sr-1")
ILLUMINANCE = Quantity("illuminance", "lx", "W m-2")
INTENSITY = Quantity("luminous intensity", "cd", "W sr-1")

_BY_NAME = {each.name: each for each in (LUMINANCE, ILLUMINANCE, INTENSITY)}
_UNKNOWN = Quantity("", "", "")


def quantity_of(sensor: scene_pb2.Sensor) -> Quantity:
    """What a compiled scene's sensor measures."""
    match sensor.model:
        case scene_pb2.SENSOR_MODEL_PLANE | scene_pb2.SENSOR_MODEL_METERS:
            return ILLUMINANCE
        case scene_pb2.SENSOR_MODEL_INTENSITY:
            return INTENSITY
        case _:
            return LUMINANCE


def quantity_named(name: str) -> Quantity:
    """By its name; without a unit where it is not known, as of images from before it was kept."""
    return _BY_NAME.get(name, _UNKNOWN)
