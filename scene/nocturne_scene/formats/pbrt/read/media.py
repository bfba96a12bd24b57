"""Participating media of pbrt's.

As Mitsuba's, they change where a ray crosses a boundary; ours are where a body is, and add up.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import coloured_grids, colours, grids, transforms
from nocturne_scene.formats.reading.grids import Grid
from nocturne_scene.formats.reading.scene_writer import Json

_KINDS = ("homogeneous", "uniformgrid", "rgbgrid")

# Those of a medium that says nothing, 1/mm: pbrt-v4's documentation of its file format.
_ABSORPTION, _SCATTERING = (0.0011, 0.0024, 0.014), (2.55, 3.21, 3.77)

_CLEAR = ("null", "thin_pane", "mask", "blend")


@dataclass(frozen=True)
class _Grid:
    """The lattice of a medium."""

    counts: tuple[int, int, int]
    to_world: transforms.Matrix

    def of(self, values: Sequence[float], channels: int) -> list[Grid]:
        """A grid for each channel."""
        lattice = np.array(values).reshape((*self.counts[::-1], channels)).transpose(3, 2, 1, 0)
        to_world = self.to_world
        if transforms.is_mirrored(to_world):
            # The same lattice, counted from its other end.
            lattice = lattice[:, ::-1]
            to_world = to_world @ transforms.translation([1, 0, 0]) @ transforms.scaling([-1, 1, 1])
        return [Grid(channel, True, to_world, fades=True) for channel in lattice]


def add_medium(context: Context, name: str, parameters: Parameters) -> None:
    """A `MakeNamedMedium` directive."""
    if name in context.media:
        raise InputError.at(parameters.place, f'there is a medium "{name[:80]}" already')
    context.media[name] = _medium(context, name, parameters)


def _medium(context: Context, name: str, parameters: Parameters) -> list[str]:
    """Names in the document; none where light does not notice the medium."""
    kind = parameters.word("type", "")
    if kind not in _KINDS:
        context.findings.lost(
            parameters.place, f'no support for the medium "{kind}"; there are {", ".join(_KINDS)}. Empty'
        )
        parameters.ignore_all()
        return []
    if kind == "rgbgrid":
        return _coloured(context, name, parameters)
    if parameters.take("preset") is not None:
        context.findings.lost(
            parameters.place, "a preset is not supported; the default coefficients are taken"
        )
    is_grid = kind == "uniformgrid"
    absorption = spectra.coefficient(
        context, parameters, "sigma_a", 1.0 if is_grid else colours.coefficient(_ABSORPTION)
    )
    scattering = spectra.coefficient(
        context, parameters, "sigma_s", 1.0 if is_grid else colours.coefficient(_SCATTERING)
    )
    scale, g = float(parameters.number("scale", 1.0)), float(parameters.number("g", 0.0))
    if scale < 0 or not -1 < g < 1:
        raise InputError.at(parameters.place, "expected a scale that is not negative, and g between -1 and 1")
    found: Json = {}
    for field, value in (("absorption", absorption), ("scattering", scattering)):
        if value != 0.0:
            found[field] = value
    if not found or scale == 0:
        parameters.ignore_all()
        return []
    if g and "scattering" in found:
        found["phase"] = {"type": "henyey_greenstein", "g": g}
    _dark(context, parameters)
    if is_grid:
        found["density"] = _density(context, parameters, scale)
    elif scale != 1:
        found["density"] = scale
    parameters.finish()
    return [context.writer.name("media", name or "medium", found)]


def _dark(context: Context, parameters: Parameters) -> None:
    for glow in ("Le", "Lescale", "temperature", "temperaturescale", "temperatureoffset", "Lescalegrid"):
        if parameters.take(glow) is not None:
            context.findings.lost(parameters.place, f'no support for a medium\'s "{glow}": it does not glow')


def _coloured(context: Context, name: str, parameters: Parameters) -> list[str]:
    """A medium that absorbs and one that scatters, for red, green and blue each."""
    scale, g = float(parameters.number("scale", 1.0)), float(parameters.number("g", 0.0))
    if scale < 0 or not -1 < g < 1:
        raise InputError.at(parameters.place, "expected a scale that is not negative, and g between -1 and 1")
    lattice = _lattice(context, parameters)
    _dark(context, parameters)
    parts: list[coloured_grids.Part] = []
    for field, given in (("absorption", "sigma_a"), ("scattering", "sigma_s")):
        values = _values(parameters, given, lattice, 3)
        if values is None:
            continue
        phase = {"phase": {"type": "henyey_greenstein", "g": g}} if g and field == "scattering" else {}
        parts += [
            ({field: spectrum} | phase, grid, None)
            for spectrum, grid in zip(coloured_grids.by_channel(1.0, 3), lattice.of(values, 3), strict=True)
        ]
    if not parts:
        raise InputError.at(parameters.place, 'an rgbgrid needs "sigma_a" or "sigma_s"')
    parameters.finish()
    if scale == 0:
        return []
    return coloured_grids.add(context.writer, name or "medium", parts, scale, parameters.place)


def _values(parameters: Parameters, name: str, lattice: _Grid, channels: int) -> list[float] | None:
    values = parameters.numbers(name)
    if values is not None and len(values) != channels * int(np.prod(lattice.counts)):
        raise InputError.at(
            parameters.place, f'expected {channels} x nx x ny x nz, as many values of "{name}"'
        )
    if values is not None and not all(0 <= value < np.inf for value in values):
        raise InputError.at(parameters.place, "a density is not negative")
    return values


def _density(context: Context, parameters: Parameters, scale: float) -> Json:
    lattice = _lattice(context, parameters)
    values = _values(parameters, "density", lattice, 1)
    if values is None:
        raise InputError.at(parameters.place, 'a uniformgrid needs "density"')
    [grid] = lattice.of(values, 1)
    return grids.density(context.writer, grid, scale, parameters.place)


def _lattice(context: Context, parameters: Parameters) -> _Grid:
    nx, ny, nz = (parameters.whole(f"n{axis}", 1) for axis in "xyz")
    if min(nx, ny, nz) < 1:
        raise InputError.at(parameters.place, "nx, ny and nz are 1 or more")
    low = parameters.numbers("p0", 3) or [0.0, 0.0, 0.0]
    high = parameters.numbers("p1", 3) or [1.0, 1.0, 1.0]
    if not all(end > start for start, end in zip(low, high, strict=True)):
        raise InputError.at(parameters.place, '"p0" and "p1" enclose nothing')
    box = transforms.translation(low) @ transforms.scaling(np.subtract(high, low).tolist())
    return _Grid((nx, ny, nz), context.to_world() @ box)


def interior(context: Context, place: str, surface: Json, kernel: Json) -> None:
    """Put what a shape encloses into its surface. `kernel` is resolved."""
    inside, outside = context.state.media
    kind = kernel["type"]
    if inside == outside or (kind != "dielectric" and kind not in _CLEAR):
        return  # no boundary of media, or nothing gets through it
    within, around = (_named(context, name, place) for name in (inside, outside))
    if within:
        surface["interior"] = {"media": list(within)}
        context.enclosed.update(within)
    if around and kind != "dielectric":
        context.findings.lost(
            place, "a boundary that is not glass inside of a medium is not supported: media add up"
        )


def camera_medium(context: Context, place: str) -> None:
    """Note what the camera is in: a medium that no shape encloses is everywhere."""
    name = context.state.media[1]

    def add() -> None:
        found = _named(context, name, place)
        if found and not context.enclosed.intersection(found):
            context.writer.document["unbounded_media"] = list(found)

    context.later.append(add)


def _named(context: Context, name: str, place: str) -> list[str]:
    if name and name not in context.media:
        known = ", ".join(sorted(context.media)[:20]) or "none"
        raise InputError.at(place, f'no medium "{name[:80]}"; known: {known}')
    return context.media[name] if name else []
