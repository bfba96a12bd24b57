"""A sensor's meters at points and on grids, and what the image's header says of a film in metres."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.compile.workspace import Unusable
from nocturne_scene.document.instruments import Instrument, MeterGrid
from nocturne_scene.document.sensors import IrradianceMeter, Meters
from nocturne_scene.film import Film

_Values = NDArray[np.float64]
_BODIES = {
    "plane": scene_pb2.METER_BODY_PLANE,
    "cylindrical": scene_pb2.METER_BODY_CYLINDER,
    "semicylindrical": scene_pb2.METER_BODY_HALF_CYLINDER,
    "hemispherical": scene_pb2.METER_BODY_HALF_SPHERE,
    "spherical": scene_pb2.METER_BODY_SPHERE,
    "fluence": scene_pb2.METER_BODY_SPHERE,
}
_FLUENCE = 4.0
"""A sphere has four times the area of its cross-section."""

_BACKWARDS = np.array([1.0, 1.0, -1.0])
"""x, y, z to right, up and forward of a pose whose right is x and whose up is y."""


def put_meters(sensor: Meters, film: Film | None, message: scene_pb2.Sensor) -> None:
    """Meters of all pixels, and their instruments. Raises Unusable where the film is not theirs."""
    (width, height), places = sensor.layout()
    if film is not None and (film.width, film.height) != (width, height):
        raise Unusable(
            f"the instruments fill a film of {width} x {height} pixels, and not of {film.width} x "
            f"{film.height}; render with width {width} and height {height}",
            ".instruments",
        )
    pixels: list[scene_pb2.Meter | None] = [None] * (width * height)
    for instrument, (left, top) in zip(sensor.instruments, places, strict=True):
        columns = instrument.size[0]
        for index, made in enumerate(_meters(instrument, np.array(sensor.position))):
            pixels[(top + index // columns) * width + left + index % columns] = made
    last = scene_pb2.Meter()
    for meter in pixels:
        last = last if meter is None else meter
        message.meters.append(last)
    told = [_told(each, place) for each, place in zip(sensor.instruments, places, strict=True)]
    message.instruments = _text({"instruments": told, "outdoor": sensor.outdoor or ""})


def film_in_metres(sensor: IrradianceMeter, right: _Values, up: _Values) -> str:
    """Where a film lies, whose width follows from the image's shape."""
    return _text(
        {
            "film": {
                "centre": _numbers(sensor.position),
                "right": _numbers(right),
                "up": _numbers(up),
                "height": sensor.height,
            }
        }
    )


def _text(told: dict[str, Any]) -> str:
    return json.dumps(told, separators=(",", ":"))


def _numbers(values: Any) -> list[float]:
    # Minus zero becomes zero, so that equal scenes have equal bytes.
    return [round(float(value), 9) + 0.0 for value in values]


def _meters(instrument: Instrument, centre: _Values) -> Iterator[scene_pb2.Meter]:
    places = places_of(instrument)
    frames = [_frame(instrument, np.array(axis)) for axis in instrument.axes()]
    for place, (axis, facing) in zip(
        places, frames if len(frames) > 1 else frames * len(places), strict=True
    ):
        yield scene_pb2.Meter(
            place=_along_pose(np.array(place) - centre),
            normal=_along_pose(axis),
            facing=_along_pose(facing),
            body=_BODIES[instrument.measures],
            factor=_FLUENCE if instrument.measures == "fluence" else 0.0,
        )


def _frame(instrument: Instrument, axis: _Values) -> tuple[_Values, _Values]:
    """Unit vectors along an axis, and across it to where the middle of half a cylinder faces."""
    axis = _unit(axis)
    facing = np.array(instrument.facing or (0.0, 0.0, 0.0))
    if instrument.facing is None:
        facing = np.eye(3)[int(np.abs(axis).argmin())]
    return axis, _unit(facing - (facing @ axis) * axis)


def places_of(instrument: Instrument) -> list[list[float]]:
    """Of each of its meters, m, row by row from the upper left one; faces are points by then (faces.py)."""
    if instrument.grid is None:
        return [list(each) for each in instrument.points or ()]
    first, across, down = _cells(instrument.grid)
    columns, rows = instrument.grid.cells()
    return [_numbers(first + i * across + j * down) for j in range(rows) for i in range(columns)]


def _cells(grid: MeterGrid) -> tuple[_Values, _Values, _Values]:
    """The middle of the upper left one, and from there to the next ones across and down."""
    right, up = np.array(grid.right), np.array(grid.up)
    inset = grid.border * (_unit(right) + _unit(up))
    columns, rows = grid.cells()
    across = (right - 2.0 * grid.border * _unit(right)) / columns
    upwards = (up - 2.0 * grid.border * _unit(up)) / rows
    return np.array(grid.corner) + inset + 0.5 * across + (rows - 0.5) * upwards, across, -upwards


def _told(instrument: Instrument, place: tuple[int, int]) -> dict[str, Any]:
    columns, rows = instrument.size
    told: dict[str, Any] = {
        "name": instrument.name,
        "measures": instrument.measures,
        "pixels": [*place, columns, rows],
    }
    if instrument.grid is None:
        return {**told, "places": places_of(instrument)}
    first, across, down = _cells(instrument.grid)
    return {**told, "first": _numbers(first), "across": _numbers(across), "down": _numbers(down)}


def _unit(values: _Values) -> _Values:
    return np.asarray(values / np.linalg.norm(values), dtype=np.float64)


def _along_pose(values: _Values) -> scene_pb2.Vector:
    x, y, z = (float(value) + 0.0 for value in values * _BACKWARDS)
    return scene_pb2.Vector(x=x, y=y, z=z)
