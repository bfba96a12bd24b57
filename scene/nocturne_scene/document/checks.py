"""Checks that need the whole document: circles of names, uses of spectra, whether there is light."""

from collections.abc import Iterator

from nocturne_scene.document.films import MeasuredPane, Pane, SheetPane
from nocturne_scene.document.graph_checks import group_problems, kernel_graph_problems
from nocturne_scene.document.kernels import (
    CoatedDiffuse,
    Dielectric,
    DiffuseTransmitter,
    Glazing,
    Kernel,
    Lambertian,
    Phong,
    Polariser,
    Principled,
    ThinPane,
    inner_kernels,
)
from nocturne_scene.document.luminaires import ConstantEnvironment, PhotometricProfile
from nocturne_scene.document.media_checks import glows, media_problems
from nocturne_scene.document.model import SceneDocument, all_surfaces
from nocturne_scene.document.node import quoted_list
from nocturne_scene.document.problems import path
from nocturne_scene.document.spectra import ConstantSpectrum, Spectrum
from nocturne_scene.document.spectrum_checks import (
    Reference,
    absorption_problems,
    radiance_problems,
    reflectance_problems,
)
from nocturne_scene.document.surfaces import Instance, Surface
from nocturne_scene.document.textures import ColourTexture
from nocturne_scene.errors import Problem


def whole_document_problems(document: SceneDocument) -> Iterator[Problem]:
    """Yield what the schema alone cannot see; all names are known to exist."""
    graph = [*kernel_graph_problems(document), *group_problems(document)]
    yield from graph
    if graph:
        return  # what follows would go round in circles
    for name, kernel in document.kernels.items():
        yield from _kernel_problems(document, kernel, path(("kernels", name)))
    for place, surface in all_surfaces(document):
        if surface.kernel is not None and not isinstance(surface.kernel, str):
            yield from _kernel_problems(document, surface.kernel, f"{place}.kernel")
        yield from _luminaire_problems(document, surface, place)
    yield from media_problems(document, resolve_spectrum)
    yield from _surrounding_problems(document)
    yield from _range_problems(document)
    yield from _tracing_problems(document)
    something = (document.surfaces, document.instances, document.unbounded_media, document.atmosphere)
    if not any(something):
        yield Problem("$.surfaces", "expected at least 1 surface here, or instance in $.instances")
    elif not _has_light(document):
        yield Problem(
            "$.surfaces",
            "no surface has a luminaire, so the image would be black; give at least one a luminaire, or give "
            "the scene an environment",
        )


def resolve_spectrum(document: SceneDocument, reference: str | float | Spectrum) -> Spectrum:
    """Return the spectrum that a reference or bare number stands for."""
    found = document.spectra[reference] if isinstance(reference, str) else reference
    return ConstantSpectrum(constant=found) if isinstance(found, int | float) else found


def _has_light(document: SceneDocument) -> bool:
    if document.environment is not None or document.distant or document.ray_files or glows(document):
        return True
    if any(surface.luminaire is not None for surface in document.surfaces):
        return True
    waiting, seen = [instance.group for instance in document.instances], set[str]()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        for member in document.groups[name]:
            if isinstance(member, Instance):
                waiting.append(member.group)
            elif member.luminaire is not None:
                return True
    return False


def _kernel_problems(document: SceneDocument, kernel: Kernel, place: str) -> Iterator[Problem]:
    """Yield wrong uses of spectra in a kernel and those inside it; named ones where they stand."""
    for field, value in _reflectances(kernel):
        used, at = _spectrum_of(value, f"{place}.{field}")
        yield from reflectance_problems(resolve_spectrum(document, used), used, at)
    if isinstance(kernel, Dielectric) and kernel.absorption is not None:
        absorption = resolve_spectrum(document, kernel.absorption)
        yield from absorption_problems(absorption, kernel.absorption, f"{place}.absorption")
    for field, inner in inner_kernels(kernel):
        if not isinstance(inner, str):
            yield from _kernel_problems(document, inner, f"{place}.{field}")


def _reflectances(kernel: Kernel) -> list[tuple[str, Reference | ColourTexture]]:
    match kernel:
        case Lambertian() | Phong() | CoatedDiffuse():
            return [("reflectance", kernel.reflectance)]
        case Principled():
            fields = ("base", "specular_colour", "sheen")
            return [(name, getattr(kernel, name)) for name in fields if getattr(kernel, name) is not None]
        case DiffuseTransmitter():
            return [("reflectance", kernel.reflectance), ("transmittance", kernel.transmittance)]
        case ThinPane():
            return [("transmittance", kernel.transmittance)]
        case Polariser():
            return [("transmittance", kernel.transmittance), ("leakage", kernel.leakage)]
        case Glazing():
            return [
                each for index, pane in enumerate(kernel.panes) for each in _of_pane(pane, f"panes[{index}]")
            ]
    return []


def _of_pane(pane: Pane, place: str) -> list[tuple[str, Reference | ColourTexture]]:
    match pane:
        case SheetPane():
            return [(f"{place}.transmittance", pane.transmittance)]
        case MeasuredPane():
            fields = ("front_reflectance", "back_reflectance", "transmittance")
            return [(f"{place}.{name}", getattr(pane, name)) for name in fields]
    return []


def _spectrum_of(value: Reference | ColourTexture, place: str) -> tuple[Reference, str]:
    if isinstance(value, ColourTexture):
        return value.spectrum, f"{place}.spectrum"
    return value, place


def _luminaire_problems(document: SceneDocument, surface: Surface, place: str) -> Iterator[Problem]:
    luminaire = surface.luminaire
    if luminaire is None or luminaire.radiance is None:
        return
    used, at = _spectrum_of(luminaire.radiance, f"{place}.luminaire.radiance")
    relative = isinstance(luminaire.profile, PhotometricProfile) or luminaire.has_amount
    yield from radiance_problems(resolve_spectrum(document, used), used, at, may_be_relative=relative)


MET_BY_PHOTONS = ("irradiance_meter", "intensity_meter")
"""Types of sensors that photons from luminaires can meet."""

CAMERAS = ("pinhole", "thin_lens", "orthographic", "panorama")
"""Types of sensors that photons from luminaires can be sent to."""


def _surrounding_problems(document: SceneDocument) -> Iterator[Problem]:
    environment = document.environment
    if isinstance(environment, ConstantEnvironment):
        used = environment.radiance
        yield from radiance_problems(resolve_spectrum(document, used), used, "$.environment.radiance")
    for index, file in enumerate(document.ray_files):
        if file.radiance is not None:
            found = resolve_spectrum(document, file.radiance)
            place = path(("ray_files", index, "radiance"))
            yield from radiance_problems(found, file.radiance, place, may_be_relative=True)
    for index, disc in enumerate(document.distant):
        for field in ("radiance", "irradiance"):
            reference = getattr(disc, field)
            if reference is not None:
                place = path(("distant", index, field))
                yield from radiance_problems(resolve_spectrum(document, reference), reference, place)


def _range_problems(document: SceneDocument) -> Iterator[Problem]:
    within, sensor = document.wavelength_range, document.sensor
    if sensor.measures is None and not within.has_all_visible:
        yield Problem(
            "$.wavelengths",
            f"the sensor's X, Y and Z are of 360 to 830 nm, and the scene has {within} only; expected all of "
            'these, or what else the sensor measures, such as "radiant" in $.sensor.measures',
        )
    bands = sensor.bands
    if bands is not None and not (within.first <= bands.first and bands.last <= within.last):
        yield Problem(
            "$.sensor.bands", f"reach from {bands.first} to {bands.last} nm; the scene has {within} only"
        )


def _tracing_problems(document: SceneDocument) -> Iterator[Problem]:
    sensor = document.sensor.type
    if document.ray_files and sensor not in MET_BY_PHOTONS:
        yield Problem(
            "$.ray_files",
            f"only photons that start along the rays bring their light, and these don't meet a {sensor}; "
            f"expected a sensor whose type is one of {quoted_list(MET_BY_PHOTONS)}",
        )
    if document.ray_files and document.tracing.direction in ("adjoint", "both"):
        yield Problem(
            "$.tracing.direction",
            'photons from the sensor don\'t find the rays of files; expected "forward", or "auto"',
        )
    if document.tracing.direction == "forward" and sensor not in MET_BY_PHOTONS:
        yield Problem(
            "$.tracing.direction",
            f'"forward" needs a sensor that photons can meet, and a {sensor} has no size; expected "adjoint" '
            f"or a sensor whose type is one of {quoted_list(MET_BY_PHOTONS)}",
        )
    if document.tracing.direction == "both" and sensor not in CAMERAS:
        yield Problem(
            "$.tracing.direction",
            f'"both" needs a camera, and a {sensor} is none; expected "adjoint" or a sensor whose type is '
            f"one of {quoted_list(CAMERAS)}",
        )
