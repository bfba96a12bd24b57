"""Mixes of light groups: the image of other dimming, from an EXR file whose channels tell groups apart.

X, Y and Z are sums over groups of factor times channel. The error of Y is that of this sum: from the channel
of each two groups together comes how far theirs go together, Cov(a, b) = (Var(a + b) - Var a - Var b) / 2,
since one path may meet lamps of both, and of two lamps that a photon may be sent to it is sent to one. Errors
of X and Z are at most what is written, the sum of factor times error; how X, Y and Z go together is not known
of mixes, and 0 is written.
"""

import json
import math
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from nocturne_scene.errors import InputError
from nocturne_scene.layers import CHANNELS
from nocturne_scene.responses import group_channels, light_groups_in, pair_channel
from nocturne_scene.tile_sums import PAIRS, Values

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
_CORRELATIONS = tuple(f"{pair}.{what}" for pair in PAIRS for what in ("correlation", "blockCorrelation"))

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
    all_factors = _of_all_groups(str(image), light_groups_in(list(channels)), factors)
    mean, error = mixed(channels, all_factors)
    found: dict[str, Any] = {name: channels[name] for name in _KEPT if name in channels}
    names = ["X", "Y", "Z"]
    found |= planes(names, mean.astype(np.float32))
    found |= planes([f"{name}.stderr" for name in names], error.astype(np.float32))
    found |= planes("RGB", linear_srgb(mean.astype(np.float32)))
    found |= {name: np.zeros(mean.shape[:2], dtype=np.float32) for name in _CORRELATIONS}
    header = {name: value for name, value in header.items() if name != "channels"}
    header[MIX] = json.dumps(all_factors)
    try:
        with OpenEXR.File(header, found) as file:
            file.write(str(output))
    except RuntimeError as trouble:
        raise OSError(f"can't write {output}: {trouble}") from trouble


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


def mixed(channels: Planes, factors: Mapping[str, float]) -> tuple[Values, Values]:
    """X, Y, Z and their standard errors, both of shape (height, width, 3), from a file's channels."""
    mean = np.sum([factor * _xyz(channels, group) for group, factor in factors.items()], axis=0)
    error = np.sum([factor * _xyz(channels, group, ".stderr") for group, factor in factors.items()], axis=0)
    error[..., 1] = np.sqrt(_variance(channels, {group: each for group, each in factors.items() if each}))
    return mean, error


def _xyz(channels: Planes, group: str, what: str = "") -> Values:
    return np.stack([channels[f"{name}{what}"].astype(np.float64) for name in group_channels(group)], axis=-1)


def _variance(channels: Planes, factors: Mapping[str, float]) -> Values:
    """Of Y."""

    def error_of(channel: str) -> Values:
        return channels[f"{channel}.stderr"].astype(np.float64)

    errors = {group: error_of(group_channels(group)[1]) for group in factors}
    shape = channels["Y"].shape
    found = sum((np.square(factors[group] * errors[group]) for group in factors), start=np.zeros(shape))
    for one, other in combinations(factors, 2):
        # As they stand in the file.
        together = next(
            name for name in (pair_channel(one, other), pair_channel(other, one)) if name in channels
        )
        most = errors[one] * errors[other]
        covariance = (np.square(error_of(together)) - np.square(errors[one]) - np.square(errors[other])) / 2
        found += 2 * factors[one] * factors[other] * np.clip(covariance, -most, most)
    # Errors are themselves uncertain, and rounded to seven digits.
    return np.maximum(found, 0.0)
