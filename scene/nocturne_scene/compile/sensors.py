"""The sensor of a scene document as the tracer's message."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.bands import band_name
from nocturne_scene.compile import spectra
from nocturne_scene.compile.meters import film_in_metres, put_meters
from nocturne_scene.compile.placement import motion_steps
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.sensors import (
    Bands,
    IntensityMeter,
    IrradianceMeter,
    Meters,
    Orthographic,
    Panorama,
    Pinhole,
    RadianceMeter,
    Sensor,
    ThinLens,
)
from nocturne_scene.film import Film
from nocturne_scene.limits import MAX_FURTHER_RESPONSES
from nocturne_scene.meshes.similarity import Similarity
from nocturne_scene.quantities import measured_by, photometric_quantity_of
from nocturne_scene.responses import (
    COLOUR,
    LIGHT_PARTS,
    POLARISERS,
    STOKES,
    counts_light_groups,
    stokes_channel,
)
from nocturne_scene.spectra import colour_basis, published
from nocturne_scene.spectra.named_responses import RESPONSES
from nocturne_scene.spectra.wavelength_range import WavelengthRange

_Direction = NDArray[np.float64]
_WAVELENGTHS = {
    "response": scene_pb2.WAVELENGTH_SAMPLING_RESPONSE,
    "uniform": scene_pb2.WAVELENGTH_SAMPLING_UNIFORM,
}
_MODELS = {
    "pinhole": scene_pb2.SENSOR_MODEL_PERSPECTIVE,
    "thin_lens": scene_pb2.SENSOR_MODEL_PERSPECTIVE,
    "orthographic": scene_pb2.SENSOR_MODEL_ORTHOGRAPHIC,
    "panorama": scene_pb2.SENSOR_MODEL_PANORAMA,
    "irradiance_meter": scene_pb2.SENSOR_MODEL_PLANE,
    "radiance_meter": scene_pb2.SENSOR_MODEL_RADIANCE_METER,
    "intensity_meter": scene_pb2.SENSOR_MODEL_INTENSITY,
    "meters": scene_pb2.SENSOR_MODEL_METERS,
}


def compile_sensor(workspace: Workspace, film: Film | None = None) -> scene_pb2.Sensor:
    """Return the sensor with orthonormal frames: right x up = -forward. Raises Unusable."""
    sensor = workspace.document.sensor
    if workspace.light_groups.too_many:
        raise Unusable(workspace.light_groups.too_many)
    first, *later = _poses(sensor, workspace.frame)
    workspace.report_motion(sensor.motion, 1 + len(later), "$.sensor")
    within = workspace.wavelengths
    if sensor.measures is None:
        response = spectra.response(sensor.observer, within).astype(np.float32)
    else:
        curve = _named_curve(sensor.measures, within, ".measures")
        response = np.repeat(curve[:, None], len("XYZ"), axis=1)
    message = scene_pb2.Sensor(
        position=first.position,
        right=first.right,
        up=first.up,
        forward=first.forward,
        later_poses=later,
        response_first_nm=within.first,
        response_step_nm=published.STEP,
        response_x=response[:, 0].tolist(),
        response_y=response[:, 1].tolist(),
        response_z=response[:, 2].tolist(),
        wavelength_sampling=_WAVELENGTHS[sensor.wavelengths],
        further_responses=[
            *(_response(workspace, name) for name in sorted(sensor.responses)),
            *_named_responses(sensor.named_responses, within),
            *_band_responses(sensor.bands, within),
            *(_colour_responses(within) if sensor.colour else ()),
            *(_part_responses(response) if sensor.light_parts else ()),
            *workspace.light_groups.responses(response),
        ],
        model=_MODELS[sensor.type],
    )
    if getattr(sensor, "stokes", False):
        message.further_responses.extend(_stokes_responses(message, sensor.light_parts))
    if sensor.measures is not None:
        measured = measured_by(photometric_quantity_of(message.model), sensor.measures)
        message.quantity.name = measured.name
        message.quantity.unit = measured.unit
        message.quantity.response_unit = measured.response_unit
    _put_optics(message, sensor)
    if isinstance(sensor, Meters):
        put_meters(sensor, film, message)
    if isinstance(sensor, IrradianceMeter):
        _, right, up = _frame(sensor)
        message.instruments = film_in_metres(sensor, right, up)
    return message


def vector(values: _Direction | tuple[float, float, float]) -> scene_pb2.Vector:
    """Return three numbers as a message; minus zero becomes zero, so that equal scenes have equal bytes."""
    x, y, z = (float(value) + 0.0 for value in values)
    return scene_pb2.Vector(x=x, y=y, z=z)


def unit(values: _Direction) -> _Direction:
    """Return the direction with length 1."""
    return np.asarray(values / np.linalg.norm(values), dtype=np.float64)


def _response(workspace: Workspace, name: str) -> scene_pb2.Response:
    spectrum = workspace.spectrum(workspace.document.sensor.responses[name])
    if counts_light_groups(name):
        raise Unusable("can't be a response's name: it means light of a light group", f".responses.{name}")
    values = spectra.response_curve(spectrum, workspace.wavelengths).astype(np.float32)
    if not values.any():
        raise Unusable(f"the response is zero from {workspace.wavelengths}", f".responses.{name}")
    return scene_pb2.Response(name=name, values=values.tolist())


def _named_curve(name: str, within: WavelengthRange, suffix: str) -> NDArray[np.float32]:
    found = RESPONSES[name]
    values = found.within(within).astype(np.float32)
    if not values.any():
        raise Unusable(
            f'"{name}" is of {found.first:g} to {found.last:g} nm, and the scene of {within}', suffix
        )
    return values


def _named_responses(names: Sequence[str], within: WavelengthRange) -> Iterator[scene_pb2.Response]:
    for index, name in enumerate(names):
        values = _named_curve(name, within, f".named_responses[{index}]")
        yield scene_pb2.Response(name=name, values=values.tolist())


def _band_responses(bands: Bands | None, within: WavelengthRange) -> Iterator[scene_pb2.Response]:
    """Boxes of area 1. Curves are straight between whole nm, so neighbours overlap by one to each side of
    their edge, and together give 1."""
    if bands is None:
        return
    wavelengths = within.grid()
    for start, end in bands.edges:
        inside = (wavelengths > start) & (wavelengths < end)
        at_edge = np.isin(wavelengths, (start, end))
        outermost = at_edge & np.isin(wavelengths, (within.first, within.last))
        values = (inside + 0.5 * at_edge + 0.5 * outermost) / (end - start)
        yield scene_pb2.Response(name=band_name(0.5 * (start + end)), values=values.tolist())


def _colour_responses(within: WavelengthRange) -> Iterator[scene_pb2.Response]:
    first, last = published.COLOUR_RANGE
    if within.first > first or within.last < last:
        raise Unusable(f"colour is of {first:g} to {last:g} nm, and the scene of {within}", ".colour")
    wavelengths = within.grid()
    values = np.zeros((len(wavelengths), colour_basis.COUNT))
    values[(wavelengths >= first) & (wavelengths <= last)] = colour_basis.responses()
    for name, of_one in zip(COLOUR, values.T, strict=True):
        yield scene_pb2.Response(name=name, values=of_one.astype(np.float32).tolist())


def _part_responses(observer: NDArray[np.float32]) -> Iterator[scene_pb2.Response]:
    """X, Y and Z of direct and of indirect light."""
    light = {"direct": scene_pb2.LIGHT_PART_DIRECT, "indirect": scene_pb2.LIGHT_PART_INDIRECT}
    for part, names in LIGHT_PARTS.items():
        for axis, name in enumerate(names):
            yield scene_pb2.Response(name=name, values=observer[:, axis].tolist(), light=light[part])


def _stokes_responses(message: scene_pb2.Sensor, light_parts: bool) -> list[scene_pb2.Response]:
    """S1, S2, S3 of X, Y, Z and of all further responses so far; then light behind polarisers."""
    if light_parts or any(each.HasField("light_group") for each in message.further_responses):
        raise Unusable("can't be told of light groups, or of direct and indirect light", ".stokes")
    observer = (message.response_x, message.response_y, message.response_z)
    curves = [*zip("XYZ", observer, strict=True)]
    curves += [(each.name, each.values) for each in message.further_responses]
    found = [
        scene_pb2.Response(name=stokes_channel(layer, name), values=values, stokes=number)
        for number, layer in enumerate(STOKES, start=1)
        for name, values in curves
    ]
    return [*found, *_behind_polarisers(curves)]


_Curves = Sequence[tuple[str, Sequence[float]]]

_NO_FACTOR = 1e-9


def _behind_polarisers(curves: _Curves) -> Iterator[scene_pb2.Response]:
    """Of Y and, as far as there is room for all of them, of the further responses."""
    values, first = len(curves), len("XYZ")
    every = [1, *range(first, values)]
    room = MAX_FURTHER_RESPONSES - (len(STOKES) + 1) * values + first
    for place in every if len(POLARISERS) * len(every) <= room else every[:1]:
        name, curve = curves[place]
        for layer, degrees in POLARISERS.items():
            twice = math.radians(2.0 * degrees)
            factors = {0: 0.5, 1: 0.5 * math.cos(twice), 2: 0.5 * math.sin(twice)}
            terms = [
                # S1 and S2 follow S0 of all.
                scene_pb2.Response.Term(value=place + values * stokes, factor=factor)
                for stokes, factor in factors.items()
                if abs(factor) > _NO_FACTOR
            ]
            yield scene_pb2.Response(name=stokes_channel(layer, name), values=curve, terms=terms)


def _put_optics(message: scene_pb2.Sensor, sensor: Sensor) -> None:
    if isinstance(sensor, Pinhole | ThinLens):
        message.vertical_field_of_view = math.radians(sensor.vertical_field_of_view_degrees)
    match sensor:
        case ThinLens():
            message.lens_radius = sensor.lens_radius
            message.focus_distance = sensor.focus_distance
            if sensor.aperture is not None:
                message.aperture_blades = sensor.aperture.blades
                message.aperture_angle = math.radians(sensor.aperture.rotation_degrees)
        case Orthographic() | IrradianceMeter():
            message.height = sensor.height
        case RadianceMeter():
            message.height = sensor.diameter
            message.acceptance = math.radians(sensor.cone_degrees) / 2
        case IntensityMeter():
            message.lamp_radius = sensor.lamp_radius


def _poses(sensor: Sensor, frame: Similarity) -> list[scene_pb2.Pose]:
    """The sensor at equally spaced times; one entry: it is at rest."""
    steps = motion_steps(sensor.motion)
    if any(abs(step.scale - 1) > 1e-12 for step in steps):
        raise Unusable("a sensor has no scale; leave it out", ".motion.placements")
    forward, right, up = _frame(sensor)
    position = np.array(sensor.position)
    return [_pose(frame.after(step), position, forward, right, up) for step in steps]


def _pose(
    step: Similarity, position: _Direction, forward: _Direction, right: _Direction, up: _Direction
) -> scene_pb2.Pose:
    return scene_pb2.Pose(
        position=vector(step.points(position)),
        right=vector(step.turned(right)),
        up=vector(step.turned(up)),
        forward=vector(step.turned(forward)),
    )


def _frame(sensor: Sensor) -> tuple[_Direction, _Direction, _Direction]:
    """Forward, right and up."""
    match sensor:
        case IntensityMeter():
            forward = unit(np.array(sensor.axis))
            zero = np.array(sensor.zero)
            right = unit(zero - (zero @ forward) * forward)
            return forward, right, np.cross(right, forward)
        case Panorama():
            up = unit(np.array(sensor.up))
            view = np.subtract(sensor.look_at, sensor.position)
            forward = unit(view - (view @ up) * up)
            return forward, np.cross(forward, up), up
        case Meters():
            # So that right, up and backwards are x, y and z.
            return np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        case IrradianceMeter():
            forward, towards = unit(np.array(sensor.facing())), np.array(sensor.upwards())
        case _:
            forward, towards = unit(np.subtract(sensor.look_at, sensor.position)), np.array(sensor.up)
    right = unit(np.cross(forward, unit(towards)))
    return forward, right, np.cross(right, forward)
