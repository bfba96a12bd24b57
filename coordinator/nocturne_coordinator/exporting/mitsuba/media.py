"""What fills bodies as Mitsuba's media."""

from xml.etree.ElementTree import Element

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_coordinator.exporting.compiled import Body, Medium, Table
from nocturne_coordinator.exporting.mitsuba.context import Context
from nocturne_coordinator.exporting.mitsuba.elements import plugin, reference, spectrum
from nocturne_coordinator.scene.published import visible_wavelengths


def medium(context: Context, body: Body | None, name: str, place: str) -> list[Element]:
    """A reference to what fills a body, under a parameter's name; nothing for nothing."""
    if body is None or body.is_empty:
        return []
    first, *others = body.media
    if any(each.phase != first.phase and not each.scattering.is_black for each in others):
        context.findings.lost(place, "media with different phase functions in one body can't be exported")
    if any(each.density is not None for each in body.media):
        context.findings.lost(place, "a density grid can't be exported yet")
    key = repr(body.media)
    if key not in context.media:
        context.media[key] = f"medium{len(context.media)}"
        context.root.append(_homogeneous(context, body.media, context.media[key], place))
    return [reference(context.media[key], name)]


def _homogeneous(context: Context, media: tuple[Medium, ...], id_: str, place: str) -> Element:
    at = visible_wavelengths()
    absorption, scattering = (
        np.sum([getattr(each, name).at(at) for each in media], axis=0)
        for name in ("absorption", "scattering")
    )
    total = absorption + scattering
    albedo = np.divide(scattering, total, out=np.zeros_like(total), where=total > 0)
    found = plugin("medium", "homogeneous", id_=id_)
    found.append(spectrum("sigma_t", Table.visible(total)))
    found.append(spectrum("albedo", Table.visible(albedo)))
    scatterer = next((each for each in media if not each.scattering.is_black), media[0])
    found.append(_phase(context, scatterer.phase, place))
    return found


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
            context.findings.lost(place, "Rayleigh scattering that depolarises has no equal in Mitsuba")
        case _:
            context.findings.lost(
                place, "a phase function by a table or by Mie's theory has no equal in Mitsuba"
            )
    return plugin("phase", "isotropic")
