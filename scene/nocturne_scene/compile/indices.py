"""Indices of refraction of a scene document as indices of compiled spectra."""

from nocturne_scene.compile import spectra
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.indices import (
    CauchyIndex,
    ComplexIndex,
    SellmeierIndex,
    TableExtinction,
    TableIndex,
)
from nocturne_scene.spectra import indices

AnyIndex = str | float | SellmeierIndex | CauchyIndex | TableIndex


def compile_index(workspace: Workspace, index: AnyIndex) -> int:
    """Return the index of a spectrum; raises BadIndexError where a formula leaves the possible."""
    within = workspace.spectral
    match index:
        case str():
            message = indices.compile_dielectric(indices.dielectric(index).n, within)
        case SellmeierIndex():
            formula = indices.sellmeier(index.sellmeier.b, index.sellmeier.c)
            message = indices.compile_dielectric(formula, within)
        case CauchyIndex():
            message = indices.compile_dielectric(indices.cauchy(index.cauchy), within)
        case TableIndex():
            message = spectra.tabulated(index.table, within=within)
        case _:
            message = spectra.tabulated([(1.0, index)], within=within)
    return workspace.spectra.index_of(message)


def compile_complex(workspace: Workspace, index: str | ComplexIndex) -> tuple[int, int]:
    """Return the indices of the spectra of n and k."""
    if isinstance(index, str):
        n, k = indices.compile_metal(index, workspace.spectral)
        return workspace.spectra.index_of(n), workspace.spectra.index_of(k)
    knots = index.k.table if isinstance(index.k, TableExtinction) else [(1.0, index.k)]
    try:
        real = compile_index(workspace, index.n)
    except indices.BadIndexError as error:
        raise Unusable(str(error), ".n") from None
    return real, workspace.spectra.index_of(spectra.tabulated(knots, within=workspace.spectral))
