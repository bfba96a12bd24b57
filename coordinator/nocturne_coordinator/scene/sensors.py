"""The sensor of a scene document as the tracer's message."""

import math

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_coordinator.scene import spectra
from nocturne_coordinator.scene.model import Pinhole, ThinLens

_WAVELENGTHS = {
    "response": scene_pb2.WAVELENGTH_SAMPLING_RESPONSE,
    "uniform": scene_pb2.WAVELENGTH_SAMPLING_UNIFORM,
}


def compile_sensor(sensor: Pinhole | ThinLens) -> scene_pb2.Sensor:
    """Return the sensor with an orthonormal frame: right x up = -forward."""
    forward = _unit(np.subtract(sensor.look_at, sensor.position))
    right = _unit(np.cross(forward, _unit(np.array(sensor.up))))
    up = np.cross(right, forward)
    response = spectra.response().astype(np.float32)
    message = scene_pb2.Sensor(
        position=vector(sensor.position),
        right=vector(right),
        up=vector(up),
        forward=vector(forward),
        vertical_field_of_view=math.radians(sensor.vertical_field_of_view_degrees),
        response_first_nm=spectra.FIRST,
        response_step_nm=spectra.RESPONSE_STEP,
        response_x=response[:, 0].tolist(),
        response_y=response[:, 1].tolist(),
        response_z=response[:, 2].tolist(),
        wavelength_sampling=_WAVELENGTHS[sensor.wavelengths],
    )
    if isinstance(sensor, ThinLens):
        message.lens_radius = sensor.lens_radius
        message.focus_distance = sensor.focus_distance
    return message


def vector(values: NDArray[np.float64] | tuple[float, float, float]) -> scene_pb2.Vector:
    """Return three numbers as a message; minus zero becomes zero, so that equal scenes have equal bytes."""
    x, y, z = (float(value) + 0.0 for value in values)
    return scene_pb2.Vector(x=x, y=y, z=z)


def _unit(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values / np.linalg.norm(values)
