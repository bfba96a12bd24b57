"""Checks of media that need the whole document."""

from collections.abc import Callable, Iterator

from nocturne_scene.document import bounds
from nocturne_scene.document.media import Medium, RayleighPhase, TabulatedPhase
from nocturne_scene.document.model import SceneDocument, all_surfaces
from nocturne_scene.document.problems import path
from nocturne_scene.document.shapes import MediumBox
from nocturne_scene.document.spectra import Spectrum
from nocturne_scene.document.spectrum_checks import (
    Reference,
    coefficient_problems,
    depolarisation_problems,
    reflectance_problems,
)
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.errors import Problem

Resolve = Callable[[SceneDocument, Reference], Spectrum]


def media_problems(document: SceneDocument, resolve: Resolve) -> Iterator[Problem]:
    """Yield wrong uses of spectra and grids in media, in interiors and in the atmosphere."""
    for name, medium in document.media.items():
        yield from _medium_problems(document, medium, path(("media", name)), resolve)
    for place, surface in all_surfaces(document):
        yield from _box_problems(document, surface, place)
    if document.atmosphere is not None:
        used = document.atmosphere.ground_reflectance
        yield from reflectance_problems(resolve(document, used), used, "$.atmosphere.ground_reflectance")


def glows(document: SceneDocument) -> bool:
    """Whether a medium that is used somewhere emits light."""
    used = set(document.unbounded_media)
    for _, surface in all_surfaces(document):
        if surface.interior is not None:
            used.update(surface.interior.media)
    return any(document.media[name].temperature is not None for name in used)


def _medium_problems(
    document: SceneDocument, medium: Medium, place: str, resolve: Resolve
) -> Iterator[Problem]:
    for field in ("absorption", "scattering"):
        reference = getattr(medium, field)
        if reference is not None:
            yield from coefficient_problems(resolve(document, reference), reference, f"{place}.{field}")
    for index, dye in enumerate(medium.fluorescence):
        used = dye.absorption
        yield from coefficient_problems(
            resolve(document, used), used, f"{place}.fluorescence[{index}].absorption"
        )
    match medium.phase:
        case RayleighPhase() as phase:
            yield from depolarisation_problems(
                resolve(document, phase.depolarisation), phase.depolarisation, f"{place}.phase.depolarisation"
            )
        case TabulatedPhase() as phase:
            count = len(phase.cosines) * len(phase.wavelengths)
            if count > bounds.PHASE_VALUES:
                yield Problem(
                    f"{place}.phase.values", f"{count} values; at most {bounds.PHASE_VALUES} are accepted"
                )


def _box_problems(document: SceneDocument, surface: Surface, place: str) -> Iterator[Problem]:
    if not isinstance(surface.shape, MediumBox):
        return
    if surface.shape.medium not in (name for name, _ in _grids(document)):
        known = [f'"{name}"' for name, _ in _grids(document)]
        yield Problem(
            f"{place}.shape.medium",
            f'the density of "{surface.shape.medium}" is no grid; '
            + (f"expected one of {', '.join(known[: bounds.CHOICES_SHOWN])}" if known else "none is"),
        )
    if place.startswith("$.groups"):
        yield Problem(
            f"{place}.shape",
            "instances would move the box away from its grid, which stays; put it into $.surfaces",
        )
    moved = surface.model_fields_set & {"scale", "rotate", "translate", "motion"}
    for field in sorted(moved):
        yield Problem(f"{place}.{field}", "the box stands where the medium's grid stands; leave it out")


def _grids(document: SceneDocument) -> list[tuple[str, Medium]]:
    return [(name, medium) for name, medium in document.media.items() if medium.grid_density() is not None]
