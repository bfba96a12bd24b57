"""What fills bodies as Mitsuba's media."""

from xml.etree.ElementTree import Element

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.mitsuba.write.context import Context
from nocturne_scene.formats.mitsuba.write.elements import parameter, plugin, reference, spectrum
from nocturne_scene.formats.mitsuba.write.volumes import density
from nocturne_scene.formats.writing.compiled import Body, Medium
from nocturne_scene.formats.writing.tables import Array, Table
from nocturne_scene.spectra.published import visible_wavelengths

# Part of the light, more or less, by which even scattering may depend on wavelength. Rayleigh's phase
# function is at most half off that.
_MAX_SPREAD = 0.01


def medium(context: Context, body: Body | None, name: str, place: str) -> list[Element]:
    """A reference to what fills a body, under a parameter's name; nothing for nothing."""
    if body is None or body.is_empty:
        return []
    scatterer = context.compiled.scatterer(body, place)
    key = repr(body.media)
    if key not in context.media:
        context.media[key] = f"medium{len(context.media)}"
        make = _homogeneous if all(each.density is None for each in body.media) else _heterogeneous
        made = make(context, body.media, context.media[key], place)
        made.append(_phase(context, scatterer.phase, place))
        context.root.append(made)
    return [reference(context.media[key], name)]


def _homogeneous(context: Context, media: tuple[Medium, ...], id_: str, place: str) -> Element:
    del context, place
    found = plugin("medium", "homogeneous", id_=id_)
    found.append(spectrum("sigma_t", _extinction(media)))
    found.append(spectrum("albedo", _albedo(media)))
    return found


def _heterogeneous(context: Context, media: tuple[Medium, ...], id_: str, place: str) -> Element:
    """Its volumes have no spectra but by RGB, so that extinction must be the same at all wavelengths."""
    found = plugin("medium", "heterogeneous", id_=id_)
    if len(media) > 1:
        context.findings.lost(place, "a density grid beside other media in one body can't be exported")
    [grid, *_] = [each.density for each in media if each.density is not None]
    volume = density(context, grid, id_, place)
    if volume is not None:
        found.append(volume)
    total = np.add(*_coefficients(media))
    # Spectra are in single precision.
    if np.ptp(total) > 1e-6 * np.max(total):
        context.findings.lost(
            place, "a density grid whose extinction depends on wavelength is not supported by Mitsuba"
        )
    parameter(found, "scale", grid.scale * float(np.mean(total)))
    albedo = plugin("volume", "constvolume", name="albedo")
    albedo.append(spectrum("value", _albedo(media)))
    found.append(albedo)
    return found


def _extinction(media: tuple[Medium, ...]) -> Table:
    absorption, scattering = _coefficients(media)
    return Table.visible(absorption + scattering)


def _albedo(media: tuple[Medium, ...]) -> Table:
    absorption, scattering = _coefficients(media)
    total = absorption + scattering
    return Table.visible(np.divide(scattering, total, out=np.zeros_like(total), where=total > 0))


def _coefficients(media: tuple[Medium, ...]) -> tuple[Array, Array]:
    at = visible_wavelengths()
    absorption = np.sum([each.absorption.at(at) for each in media], axis=0)
    scattering = np.sum([each.scattering.at(at) for each in media], axis=0)
    return absorption, scattering


def _phase(context: Context, phase: scene_pb2.PhaseFunction, place: str) -> Element:
    match phase.WhichOneof("shape"):
        case "henyey_greenstein":
            g = phase.henyey_greenstein.g
            return plugin("phase", "isotropic") if g == 0 else plugin("phase", "hg", g=g)
        case "double_henyey_greenstein":
            both = phase.double_henyey_greenstein
            # The weight is that of the second.
            found = plugin("phase", "blendphase", weight=1 - both.weight)
            found.extend([plugin("phase", "hg", g=g) for g in (both.g_first, both.g_second)])
            return found
        case "rayleigh" if not phase.rayleigh.HasField("depolarisation"):
            return plugin("phase", "rayleigh")
        case "rayleigh":
            return _depolarising(context, phase.rayleigh, place)
        case _:
            context.findings.lost(
                place, "a phase function by a table or by Mie's theory is not supported by Mitsuba"
            )
    return plugin("phase", "isotropic")


def _depolarising(context: Context, phase: scene_pb2.RayleighPhase, place: str) -> Element:
    """A part that is scattered evenly, and Rayleigh's without: exact where they don't depend on wavelength.

    (1 + 3 gamma + (1 - gamma) cos^2) / (1 + 2 gamma) as a mix of 4 / 3 and 1 + cos^2; A. Bucholtz,
    "Rayleigh-scattering calculations for the terrestrial atmosphere", Applied Optics 34 (1995).
    """
    ratio = context.compiled.table(phase.depolarisation).at(visible_wavelengths())
    gamma = ratio / (2 - ratio)
    even = 3 * gamma / (1 + 2 * gamma)
    spread = float(np.ptp(even)) / 2
    if spread > _MAX_SPREAD:
        context.findings.lost(
            place, "depolarisation that depends much on wavelength is not supported by Mitsuba"
        )
    elif spread > 0:
        context.findings.note(
            place,
            "depolarisation does not depend on wavelength: the phase function is off by at most "
            f"{spread / 2:.1g}",
        )
    found = plugin("phase", "blendphase", weight=float(even.max() + even.min()) / 2)
    found.extend([plugin("phase", "rayleigh"), plugin("phase", "isotropic")])
    return found
