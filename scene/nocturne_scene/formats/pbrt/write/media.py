"""What bodies enclose, as pbrt's media."""

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.pbrt.write.context import Context
from nocturne_scene.formats.pbrt.write.directives import directive, quoted, real, spectrum, text
from nocturne_scene.formats.writing.compiled import Body
from nocturne_scene.formats.writing.tables import Table
from nocturne_scene.spectra.published import visible_wavelengths


def medium(context: Context, body: Body | None, place: str) -> str:
    """The name of what fills a body; empty for nothing."""
    if body is None or body.is_empty:
        return ""
    scatterer = context.compiled.scatterer(body, place)
    if any(each.density is not None for each in body.media):
        context.findings.lost(place, "a density grid can't be exported yet")
    key = repr(body.media)
    if key not in context.media:
        context.media[key] = f"medium{len(context.media)}"
        line = directive(
            "MakeNamedMedium",
            quoted(context.media[key]),
            text("type", "homogeneous"),
            spectrum("sigma_a", _sum([each.absorption for each in body.media])),
            spectrum("sigma_s", _sum([each.scattering for each in body.media])),
            real("g", _g(context, scatterer.phase, place)),
        )
        context.head.append(line)
    return context.media[key]


def _sum(tables: list[Table]) -> Table:
    if len(tables) == 1:
        return tables[0]
    return Table.visible(np.sum([table.at(visible_wavelengths()) for table in tables], axis=0))


def _g(context: Context, phase: scene_pb2.PhaseFunction, place: str) -> float:
    if phase.WhichOneof("shape") == "henyey_greenstein":
        return phase.henyey_greenstein.g
    context.findings.lost(
        place, "phase functions other than Henyey and Greenstein's are not supported by pbrt"
    )
    return 0.0
