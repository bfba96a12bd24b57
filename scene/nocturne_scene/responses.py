"""What the sensor's further responses may be called."""

import re
from collections.abc import Iterator, Sequence

from nocturne_scene.bands import is_band
from nocturne_scene.limits import MAX_FURTHER_RESPONSES

_NAME = re.compile("[A-Za-z][A-Za-z0-9_-]{0,30}")
# What an EXR's channels mean by convention, or here.
_TAKEN = frozenset("XYZRGBAn")

LIGHT_PARTS = {part: tuple(f"{part}.{axis}" for axis in "XYZ") for part in ("direct", "indirect")}
"""Names of responses to a part of the light, by part."""

LIGHT_GROUP_PATTERN = "^([A-Za-z][A-Za-z0-9_-]{0,30})?$"
"""Of a light group's name; none: of no group."""

REST = "rest"
"""The light of lights without a group, next to groups."""

STOKES = ("S1", "S2", "S3")
"""Layers of the Stokes vector's other elements, of X, Y, Z and of each further response; S0 is the light."""

POLARISERS = {"polariser0": 0.0, "polariser22": 22.5, "polariser45": 45.0}
"""Layers of the light behind an ideal polariser, by its angle from the sensor's right in degrees: half of
S0 + S1 cos 2 angle + S2 sin 2 angle. Their variances have the covariances of S0, S1 and S2 in a pixel."""

_POLARISED = (*STOKES, *POLARISERS)

TAKEN_LAYERS = frozenset(
    {
        REST,
        *LIGHT_PARTS,
        *_POLARISED,
        *_TAKEN,
        "albedo",
        "N",
        "depth",
        "P",
        "id",
        "emission",
        "denoised",
        "difference",
    }
)
"""Not names of light groups: the part of a channel's name before its point means something else."""

_OF_GROUPS = re.compile(r"([A-Za-z][A-Za-z0-9_-]{0,30})\.[XYZ]")

COLOUR = tuple(f"colour.{number:02d}" for number in range(43))
"""Names of responses that give a light's colour, by wavelength; `spectra.colour_basis` has their curves."""

_OF_SENSORS = frozenset(name for names in LIGHT_PARTS.values() for name in names) | frozenset(COLOUR)


def group_channels(group: str) -> tuple[str, str, str]:
    """Names of the channels X, Y, Z of a light group."""
    return f"{group}.X", f"{group}.Y", f"{group}.Z"


def stokes_channel(layer: str, name: str) -> str:
    """The channel of another layer next to one of S0: as spectral EXR files have it, where that is a band."""
    return f"{layer}.{name.removeprefix('S0.')}"


def is_signed(name: str) -> bool:
    """Whether a further response may be negative: of polarised light, by rounding also behind polarisers."""
    return name.partition(".")[0] in _POLARISED


def light_of(names: Sequence[str]) -> list[int]:
    """Of each value, the place of the one that counts the same light whatever its polarisation: S0 of Stokes
    channels, itself of all others."""
    places = {stokes_channel("S0", name): place for place, name in enumerate(names) if not is_signed(name)}

    def of(place: int, name: str) -> int:
        return places.get("S0." + name.partition(".")[2], place) if is_signed(name) else place

    return [of(place, name) for place, name in enumerate(names)]


def counts_light_groups(name: str) -> bool:
    """Whether a further response's name is one of light groups, or of parts of the light."""
    return _OF_GROUPS.fullmatch(name) is not None


def light_groups_in(names: Sequence[str]) -> list[str]:
    """The light groups that further responses tell apart, in order; none: they tell none."""
    found = (name.rpartition(".") for name in names if counts_light_groups(name))
    return [group for group, _, axis in found if axis == "Y" and group not in (*LIGHT_PARTS, *_POLARISED)]


def name_problems(names: Sequence[str]) -> Iterator[str]:
    """Problems of the names of a sensor's further responses, in words."""
    if len(names) > MAX_FURTHER_RESPONSES:
        yield (
            f"its sensor has {len(names)} further responses, those of `bands`, `colour` and light groups "
            f"included; expected at most {MAX_FURTHER_RESPONSES}"
        )
    for index, name in enumerate(names):
        if name in names[:index]:
            yield f"two responses are named {name!r}"
        elif is_signed(name) or is_band(name) or name in _OF_SENSORS or counts_light_groups(name):
            continue
        elif not _NAME.fullmatch(name):
            yield (
                f"{name[:40]!r} can't be a response's name: expected a letter, "
                "then at most 30 letters, digits, '_' and '-'"
            )
        elif name in _TAKEN:
            yield f"{name!r} can't be a response's name: it means another channel of an image"
