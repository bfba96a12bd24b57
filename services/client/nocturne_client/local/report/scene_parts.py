"""Luminaires and materials of a scene document, as tables of a report."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne_scene.compile.spectra import evaluate, reflectance
from nocturne_scene.document.checks import resolve_spectrum
from nocturne_scene.document.kernels import Kernel
from nocturne_scene.document.luminaires import Luminaire, PhotometricProfile
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.surfaces import Instance, Surface
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.files import read
from nocturne_scene.photometry.intensities import BadPhotometryError, flux
from nocturne_scene.spectra.published import illuminant, observer, visible_wavelengths

from nocturne_client.scene_files import DIGEST_PREFIX


@dataclass(frozen=True)
class Lamp:
    """Luminaires that are alike."""

    name: str
    count: int
    lumens: float | None
    """Of one, new and undimmed; None where the document does not say."""
    maintenance_factor: float
    dimming: float

    @property
    def used(self) -> float | None:
        """Luminous flux of all, as it is traced, lm."""
        each = self.lumens
        return None if each is None else each * self.count * self.maintenance_factor * self.dimming


def lamps_of(document: SceneDocument, files: Mapping[str, Path]) -> list[Lamp]:
    """All luminaires on surfaces, alike ones together; `files` by digest."""
    counted: Counter[Lamp] = Counter()
    for surface, count in _surfaces(document):
        if surface.luminaire is not None:
            lamp = surface.luminaire
            name, lumens = _named(lamp, surface, files)
            counted[Lamp(name, 1, lumens, lamp.maintenance_factor, lamp.dimming)] += count
    return [
        Lamp(each.name, count, each.lumens, each.maintenance_factor, each.dimming)
        for each, count in counted.items()
    ]


def _surfaces(document: SceneDocument) -> Iterator[tuple[Surface, int]]:
    """Surfaces, and at how many places each is. Placements in files are not counted."""
    yield from ((surface, 1) for surface in document.surfaces)
    shown: Counter[str] = Counter()
    waiting = [(instance, 1) for instance in document.instances if isinstance(instance, Instance)]
    while waiting:
        instance, times = waiting.pop()
        shown[instance.group] += times
        for member in document.groups.get(instance.group, ()):
            waiting += [(member, times)] if isinstance(member, Instance) else []
    for group, count in shown.items():
        for member in document.groups.get(group, ()):
            if isinstance(member, Surface):
                yield member, count


def _named(lamp: Luminaire, surface: Surface, files: Mapping[str, Path]) -> tuple[str, float | None]:
    if not isinstance(lamp.profile, PhotometricProfile):
        return surface.name or "luminaire", lamp.lumens
    file = files.get(lamp.profile.asset.removeprefix(DIGEST_PREFIX))
    if file is None:
        return surface.name or "luminaire with a photometric file", lamp.profile.lumens
    try:
        found = read(file.read_bytes())
    except (BadPhotometryError, OSError):
        return file.name, lamp.profile.lumens
    keys = [found.keywords.get(key, "") for key in ("MANUFAC", "LUMCAT", "LUMINAIRE")]
    told = " ".join(key for key in keys if key)
    return f"{told} ({file.name})" if told else file.name, lamp.profile.lumens or flux(found)


@dataclass(frozen=True)
class Material:
    """A kernel that surfaces have."""

    name: str
    kind: str
    reflectance: float | None
    """Luminous, under D65; None where it is not one number."""
    surfaces: int


def materials_of(document: SceneDocument) -> list[Material]:
    """Kernels of surfaces, alike ones together."""
    counted: Counter[str] = Counter()
    kernels: dict[str, tuple[str, Kernel]] = {}
    for surface, count in _surfaces(document):
        used = surface.kernel
        if used is None:
            continue
        name = used if isinstance(used, str) else f"(of {surface.name or 'a surface'})"
        key = name if isinstance(used, str) else repr(used)
        kernels.setdefault(key, (name, document.kernels[used] if isinstance(used, str) else used))
        counted[key] += count
    return [
        Material(name, kernel.type.replace("_", " "), _luminous(document, kernel), counted[key])
        for key, (name, kernel) in kernels.items()
    ]


def _luminous(document: SceneDocument, kernel: Kernel) -> float | None:
    """Of what a diffuse surface reflects: the sum over wavelengths with D65 and V(lambda), CIE 015:2018."""
    given = getattr(kernel, "reflectance", None)
    if kernel.type != "lambertian" or given is None:
        return None
    try:
        table = reflectance(resolve_spectrum(document, given))
    except (InputError, KeyError, TypeError, AttributeError):
        return None
    wavelengths = visible_wavelengths()
    at, power = illuminant("D65")
    weights = np.interp(wavelengths, at, power) * observer("CIE 1931 2 degree")[:, 1]
    return float(weights @ evaluate(table, wavelengths) / weights.sum())
