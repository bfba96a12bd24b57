"""What varies in space: Mitsuba's volumes."""

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import spectra
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.grids import Grid
from nocturne_scene.formats.reading.scene_files import read_bytes
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.limits import MAX_ASSET_BYTES

HEADER = struct.Struct("<3sB5i6f")
"""Of a volume's file: "VOL", version 3, the kind of its values, counts along x, y and z, channels, and a box
that counts only where it is asked for. Values follow, x first."""

FLOATS = 1
"""The kind of 32-bit floats."""


@dataclass(frozen=True)
class Volume:
    """A value times what grids say."""

    value: Json
    """A number, or a spectrum."""
    grids: tuple[Grid, ...] = ()
    """None, one, or one each for red, green and blue."""


UNIT_CUBE = Grid(np.ones((1, 1, 1)), False, np.eye(4))
"""Where a volume is that has no `to_world`."""


def volume(context: Context, properties: Properties, name: str, default: float) -> Volume:
    """Return a parameter that may vary in space."""
    element = properties.take(name)
    if element is None:
        return Volume(default)
    if element.tag != "volume":
        return Volume(spectra.coefficient(context, element))
    inner = context.properties(element)
    match element.type:
        case "constvolume":
            value = inner.take("value")
            to_world = inner.transform("to_world")
            # Mitsuba's media are where the volume of their extinction is.
            box = (_even(to_world),) if name == "sigma_t" else ()
            found = Volume(1.0 if value is None else spectra.coefficient(context, value), box)
        case "gridvolume":
            found = Volume(1.0, _grids(context, inner))
        case _:
            context.findings.lost(element.place, f'no support for the volume "{element.type}"; taken as 1')
            return Volume(1.0)
    inner.finish()
    return found


def _even(to_world: Matrix) -> Grid:
    """The box along the axes around the cube from 0 to 1, turned or not: what Mitsuba fills evenly."""
    reach = to_world[:3, :3]
    low = to_world[:3, 3] + np.minimum(reach, 0).sum(axis=1)
    size = np.abs(reach).sum(axis=1)
    box = transforms.translation(low.tolist()) @ transforms.scaling(size.tolist())
    return Grid(np.ones((1, 1, 1)), False, box)


def _grids(context: Context, properties: Properties) -> tuple[Grid, ...]:
    file = context.file(properties)
    filtered = properties.text("filter_type", "trilinear")
    if filtered not in ("trilinear", "nearest"):
        raise InputError.at(properties.place, f'no filter "{filtered[:40]}"; expected trilinear or nearest')
    if properties.text("wrap_mode", "clamp") != "clamp":
        context.findings.note(properties.place, "beyond its box the grid is empty, whatever its wrap mode")
    # Three channels always become spectra by the same rule here.
    properties.ignore("raw", "accel")
    values, box = _read(context, file)
    to_world = properties.transform("to_world")
    if properties.switch("use_grid_bbox", False):
        low, high = box[:3], box[3:]
        to_world = (
            to_world @ transforms.translation(low) @ transforms.scaling(np.subtract(high, low).tolist())
        )
    if _is_turned(to_world) and _fills_its_faces(values):
        context.findings.note(
            properties.place,
            "beyond its box the grid is empty; of a turned one Mitsuba holds the outer values as far as the "
            "box along the axes around it",
        )
    return tuple(Grid(channel, filtered == "trilinear", to_world) for channel in values)


def _is_turned(matrix: Matrix) -> bool:
    """Whether a box has other directions than the axes."""
    sizes = np.abs(matrix[:3, :3])
    return bool(np.any(np.sum(sizes > 1e-6 * sizes.max(), axis=0) > 1))


def _fills_its_faces(values: NDArray[np.float64]) -> bool:
    """Whether an outer cell is not empty."""
    return bool(np.count_nonzero(values) > np.count_nonzero(values[:, 1:-1, 1:-1, 1:-1]))


def _read(context: Context, file: Path) -> tuple[np.ndarray, list[float]]:
    """Values by channel, x, y, z, and the box that the file says."""
    shown = context.tree.files.shown(file)
    content = read_bytes(file, MAX_ASSET_BYTES, shown)
    if len(content) < HEADER.size:
        raise InputError.at(shown, "is no grid of version 3")
    magic, version, kind, *numbers = HEADER.unpack_from(content)
    counts, channels, box = numbers[:3], numbers[3], numbers[4:]
    if magic != b"VOL" or version != 3 or kind != FLOATS:
        raise InputError.at(shown, "is no grid of version 3 with 32-bit floats")
    if channels not in (1, 3):
        raise InputError.at(shown, f"a grid of {channels} channels is not supported; expected 1 or 3")
    if min(counts) < 1 or counts[0] * counts[1] * counts[2] * channels * 4 != len(content) - HEADER.size:
        raise InputError.at(shown, f"says that it has {' x '.join(map(str, counts))} values, and has not")
    if not np.all(np.isfinite(box)) or not all(
        high > low for low, high in zip(box[:3], box[3:], strict=True)
    ):
        raise InputError.at(shown, "has a box without a volume")
    shape = (*counts[::-1], channels)
    values = np.frombuffer(content, "<f4", offset=HEADER.size).reshape(shape).astype(np.float64)
    if not np.all(np.isfinite(values)) or values.min() < 0:
        raise InputError.at(shown, "holds values that are negative or not finite")
    return values.transpose(3, 2, 1, 0), list(box)
