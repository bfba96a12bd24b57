"""Mixes of light groups: the image of other dimming, from an EXR file whose channels tell groups apart.

X, Y and Z are sums over groups of factor times channel. The errors of groups go together, to both sides: one
path may meet lamps of both, and of two lamps that a photon may be sent to it is sent to one. The file has
correlations for each tile, of which pixels get covariances: in proportion to the product of both groups'
errors there, and so that the sum over a tile's pixels is the tile's.
"""

import json
import math
from collections.abc import Mapping, Sequence
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
import OpenEXR
from nocturne_scene import response_correlations
from nocturne_scene.errors import InputError
from nocturne_scene.layers import CHANNELS
from nocturne_scene.responses import group_channels, light_groups_in
from nocturne_scene.tile_sums import PAIR_FIRST, PAIR_SECOND, PAIRS, Values, block_sums, tile_sums

from nocturne_coordinator.output.images import linear_srgb, planes

MIX = "nocturne:mix"
"""An EXR attribute: the factors of all groups, JSON."""

MAX_FACTOR = 1e6
"""Of what a group had when it was traced; noise grows as much."""

# Of the image that is mixed, as if groups were alike in this.
_KEPT = (
    "n",
    *(f"{axis}.{what}" for axis in "XYZ" for what in ("blockRatio", "ownRatio", "tileRatio")),
    *(name for names in CHANNELS.values() for name in names),
)
_XYZ = len("XYZ")
T = TypeVar("T", np.float32, np.float64)

_BAND_PIXELS = 2**18
"""Of an image that are mixed at once: their covariances take a hundred times as much memory."""

Planes = Mapping[str, Values]


def write_mix(image: Path, output: Path, factors: Mapping[str, float]) -> None:
    """Writes the EXR of an image with the light of each group times a factor; 1 for groups that are not
    named. Raises InputError, and OSError where the file can't be written."""
    try:
        with OpenEXR.File(str(image), separate_channels=True) as file:
            header = dict(file.header())
            channels: dict[str, Any] = {name: each.pixels for name, each in file.channels().items()}
    except (RuntimeError, OSError) as trouble:
        raise InputError.at(str(image), f"can't be read: {trouble}") from trouble
    all_factors = _of_all_groups(str(image), light_groups_in(sorted(channels)), factors)
    correlations = header.pop(response_correlations.ATTRIBUTE, "")
    edge, together = _together(header, correlations, list(all_factors), channels["Y"].shape)
    found: dict[str, Any] = {name: channels[name] for name in _KEPT if name in channels}
    rows = edge * max(1, _BAND_PIXELS // (edge * channels["Y"].shape[1]))
    for first in range(0, channels["Y"].shape[0], rows):
        band = {name: values[first : first + rows] for name, values in channels.items()}
        of_tiles = together[first // edge : (first + rows) // edge]
        for name, values in _channels(band, all_factors, edge, of_tiles).items():
            found.setdefault(name, np.empty(channels["Y"].shape, np.float32))[first : first + rows] = values
    header = {name: value for name, value in header.items() if name != "channels"}
    header[MIX] = json.dumps(all_factors)
    try:
        with OpenEXR.File(header, found) as file:
            file.write(str(output))
    except RuntimeError as trouble:
        raise OSError(f"can't write {output}: {trouble}") from trouble


def _channels(channels: Planes, factors: Mapping[str, float], edge: int, together: Values) -> dict[str, Any]:
    """Of some rows of tiles, what differs from the image."""
    mean, covariance = mixed(channels, factors, edge, together)
    names = ["X", "Y", "Z"]
    error = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0))
    found = planes(names, mean.astype(np.float32))
    found |= planes([f"{name}.stderr" for name in names], error.astype(np.float32))
    found |= planes("RGB", linear_srgb(mean.astype(np.float32)))
    pairs = covariance[..., PAIR_FIRST, PAIR_SECOND]
    found |= planes([f"{pair}.correlation" for pair in PAIRS], _correlation(pairs, error))
    # Of a block as of its tile.
    of_tile = _correlation(_in_tiles(pairs, edge), np.sqrt(_in_tiles(np.square(error), edge)))
    return found | planes([f"{pair}.blockCorrelation" for pair in PAIRS], _spread(of_tile, edge, mean.shape))


def _of_all_groups(place: str, groups: list[str], factors: Mapping[str, float]) -> dict[str, float]:
    if not groups:
        raise InputError.at(
            place,
            "tells no light groups apart; expected the image of a scene whose lights have a light_group",
        )
    for name, factor in factors.items():
        if name not in groups:
            raise InputError.at(place, f"there is no light group {name[:40]!r}; expected {', '.join(groups)}")
        if not (math.isfinite(factor) and 0.0 <= factor <= MAX_FACTOR):
            raise InputError.at(place, f"{name} = {factor:g}; expected a factor from 0 to {MAX_FACTOR:g}")
    return {name: float(factors.get(name, 1.0)) for name in groups}


def _together(
    header: Mapping[str, Any], text: str, groups: Sequence[str], shape: tuple[int, int]
) -> tuple[int, Values]:
    """The edge of tiles, and for each of them the correlations of X, Y, Z of all groups; all 1, which makes
    errors as large as can be, where the file has none."""
    schedule = json.loads(header.get("nocturne:schedule", "{}"))
    edge = int(schedule.get("tileSize", max(shape)))
    tiles = -(-shape[0] // edge), -(-shape[1] // edge)
    own = ["X", "Y", "Z", *schedule.get("furtherResponses", ())]
    places = [own.index(name) for group in groups for name in group_channels(group) if name in own]
    size = _XYZ * len(groups)
    found = response_correlations.decode(text, tiles, len(own)) if len(places) == size else None
    if found is None:
        return edge, np.ones((*tiles, size, size))
    whole = np.zeros((*tiles, len(own), len(own)))
    whole[..., *np.tril_indices(len(own), -1)] = found
    whole += np.swapaxes(whole, -1, -2) + np.eye(len(own))
    return edge, whole[..., places, :][..., places]


def mixed(
    channels: Planes, factors: Mapping[str, float], edge: int, together: Values
) -> tuple[Values, Values]:
    """X, Y, Z, shape (height, width, 3), and covariances of their errors, shape (height, width, 3, 3), from a
    file's channels and tiles' correlations of X, Y, Z of groups."""
    mean = np.sum([factor * _xyz(channels, group) for group, factor in factors.items()], axis=0)
    errors = [_xyz(channels, group, ".stderr") for group in factors]
    by, groups = list(factors.values()), range(len(errors))
    as_traced, as_mixed = np.zeros((2, *mean.shape, _XYZ))
    for one, other in combinations_with_replacement(groups, 2):
        square = together[..., _XYZ * one :, _XYZ * other :][..., :_XYZ, :_XYZ]
        found = _covariance(errors[one], errors[other], square, edge)
        if one != other:
            found = found + np.swapaxes(found, -1, -2)
        as_traced += found
        as_mixed += by[one] * by[other] * found
    weights = _unknown(errors)
    rest = _of_image(channels) - as_traced
    part = np.divide(rest, weights, out=np.zeros_like(rest), where=weights > 0.0)
    return mean, as_mixed + part * _unknown(
        [factor * error for factor, error in zip(by, errors, strict=True)]
    )


def _covariance(one: Values, other: Values, correlation: Values, edge: int) -> Values:
    """Of pixels, shape (height, width, 3, 3), from their errors in three values each, and from how the totals
    of tiles go together."""
    both = _products(one, other)
    of_tiles = _products(*(np.sqrt(_in_tiles(np.square(each), edge)) for each in (one, other)))
    total = _in_tiles(both, edge)
    part = np.divide(correlation * of_tiles, total, out=np.zeros_like(total), where=total > 0.0)
    found: Values = both * _spread(np.clip(part, -1.0, 1.0), edge, both.shape)
    return found


def _of_image(channels: Planes) -> Values:
    errors = np.stack([channels[f"{axis}.stderr"].astype(np.float64) for axis in "XYZ"], axis=-1)
    found = _products(errors, errors)
    for pair, one, other in zip(PAIRS, PAIR_FIRST, PAIR_SECOND, strict=True):
        # By each pixel's own samples.
        own = np.sqrt(channels[f"{'XYZ'[one]}.ownRatio"] * channels[f"{'XYZ'[other]}.ownRatio"])
        found[..., one, other] *= channels[f"{pair}.correlation"] * own
        found[..., other, one] = found[..., one, other]
    return found


def _unknown(errors: Sequence[Values]) -> Values:
    """Products of errors in sum over all pairs of values whose covariance no channel has: all but those of
    a value with itself."""
    whole = np.sum(errors, axis=0)
    found = _products(whole, whole)
    places = np.arange(_XYZ)
    found[..., places, places] -= np.sum(np.square(errors), axis=0)
    return found


def _products(one: Values, other: Values) -> Values:
    found: Values = one[..., :, None] * other[..., None, :]
    return found


def _in_tiles(values: Values, edge: int) -> Values:
    return tile_sums(block_sums(values), edge)


def _spread(of_tiles: npt.NDArray[T], edge: int, shape: tuple[int, ...]) -> npt.NDArray[T]:
    """What tiles have, for each of their pixels."""
    height, width = shape[:2]
    return of_tiles.repeat(edge, axis=0)[:height].repeat(edge, axis=1)[:, :width]


def _correlation(covariance: Values, error: Values) -> npt.NDArray[np.float32]:
    both = error[..., PAIR_FIRST] * error[..., PAIR_SECOND]
    found = np.divide(covariance, both, out=np.zeros_like(both), where=both > 0.0)
    return np.clip(found, -1.0, 1.0).astype(np.float32)


def _xyz(channels: Planes, group: str, what: str = "") -> Values:
    return np.stack([channels[f"{name}{what}"].astype(np.float64) for name in group_channels(group)], axis=-1)
