"""Thin films and glazings as messages."""

from collections.abc import Sequence

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.indices import compile_complex, compile_index
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.films import FilmLayer, FilmPane, MeasuredPane, Pane, SheetPane
from nocturne_scene.document.indices import ComplexIndex
from nocturne_scene.document.kernels import Glazing
from nocturne_scene.spectra import indices
from nocturne_scene.spectra.published import Floats

# Spectra are float32: the numbers 0.7 and 0.3 add up to a little more than 1.
_ROUNDING = 1e-6


def compile_layers(
    workspace: Workspace, layers: Sequence[FilmLayer], place: str
) -> list[scene_pb2.FilmLayer]:
    """Return the layers of a film as they are written. Raises Unusable."""
    made = []
    for number, layer in enumerate(layers):
        at = f"{place}[{number}].index"
        try:
            n, k = _n_and_k(workspace, layer.index)
        except Unusable as error:
            raise Unusable(str(error), f"{at}{error.suffix}") from None
        except indices.BadIndexError as error:
            raise Unusable(str(error), at) from None
        pool = workspace.spectra.messages
        largest = max(*pool[n].values, *pool[k].values)
        if largest > bounds.FILM_INDEX:
            raise Unusable(
                f"n or k is {largest:g}; expected at most {bounds.FILM_INDEX:g} of a film's layer", at
            )
        made.append(scene_pb2.FilmLayer(n=n, k=k, thickness_nm=layer.thickness_nm))
    return made


def compile_glazing(workspace: Workspace, kernel: Glazing, *, from_back: bool) -> scene_pb2.Glazing:
    """Return the message for light from the front, or from the back. Raises Unusable."""
    panes = [_pane(workspace, pane, f".panes[{number}]") for number, pane in enumerate(kernel.panes)]
    same = panes == [_turned(pane) for pane in reversed(panes)]
    return scene_pb2.Glazing(panes=panes, from_back=from_back and not same)


def _n_and_k(workspace: Workspace, index: object) -> tuple[int, int]:
    if isinstance(index, ComplexIndex) or (isinstance(index, str) and index in indices.metals()):
        return compile_complex(workspace, index)
    clear = workspace.spectra.index_of(spectra.tabulated([(1.0, 0.0)]))
    return compile_index(workspace, index), clear  # type: ignore[arg-type]


def _pane(workspace: Workspace, pane: Pane, place: str) -> scene_pb2.Glazing.Pane:
    match pane:
        case SheetPane():
            try:
                index = compile_index(workspace, pane.index)
            except indices.BadIndexError as error:
                raise Unusable(str(error), f"{place}.index") from None
            sheet = scene_pb2.Glazing.Sheet(
                index=index,
                transmittance=workspace.reflectance(pane.transmittance),
                front=compile_layers(workspace, pane.front, f"{place}.front"),
                back=compile_layers(workspace, pane.back, f"{place}.back"),
            )
            return scene_pb2.Glazing.Pane(sheet=sheet)
        case FilmPane():
            layers = compile_layers(workspace, pane.film, f"{place}.film")
            return scene_pb2.Glazing.Pane(film=scene_pb2.Glazing.Film(layers=layers))
        case MeasuredPane():
            return _measured(workspace, pane, place)


def _measured(workspace: Workspace, pane: MeasuredPane, place: str) -> scene_pb2.Glazing.Pane:
    front, back, through = (
        workspace.reflectance(reference)
        for reference in (pane.front_reflectance, pane.back_reflectance, pane.transmittance)
    )
    pool, seen = workspace.spectra.messages, workspace.wavelengths.grid()
    for name, reflected in (("front_reflectance", front), ("back_reflectance", back)):
        total = spectra.evaluate(pool[reflected], seen) + spectra.evaluate(pool[through], seen)
        if np.any(total > 1 + _ROUNDING):
            worst = int(np.argmax(total))
            raise Unusable(
                f"reflectance and transmittance add up to {total[worst]:.6g} at {seen[worst]:g} nm; "
                "expected at most 1",
                f"{place}.{name}",
            )
    if front != back:
        measured = scene_pb2.Glazing.Measured(front=front, back=back, transmittance=through)
        return scene_pb2.Glazing.Pane(measured=measured)

    def of_sheet(part: int) -> int:
        def curve(wavelengths: Floats) -> Floats:
            reflected, passed = (spectra.evaluate(pool[each], wavelengths) for each in (front, through))
            return bare_sheet(reflected, passed)[part]

        return workspace.spectra.index_of(indices.compile_curve(curve, workspace.wavelengths))

    return scene_pb2.Glazing.Pane(sheet=scene_pb2.Glazing.Sheet(index=of_sheet(0), transmittance=of_sheet(1)))


def bare_sheet(reflectance: Floats, transmittance: Floats) -> tuple[Floats, Floats]:
    """Index of refraction and internal transmittance of a sheet that has these shares at normal incidence.

    With r of a face and t inside, T = (1 - r)^2 t / (1 - r^2 t^2) and R = r (1 + t T); M. Rubin, Solar Energy
    Materials 12, 1985.
    """
    sum_ = transmittance**2 - reflectance**2 + 2 * reflectance + 1
    root = np.sqrt(np.maximum(0.0, sum_**2 - 4 * reflectance * (2 - reflectance)))
    # The smaller root, without the difference.
    face = 2 * reflectance / (sum_ + root)
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = np.where(face > 0, (reflectance - face) / (face * transmittance), transmittance)
    inside = np.where(transmittance > 0, np.clip(inside, 0.0, 1.0), 0.0)
    amplitude = np.sqrt(face)
    return (1 + amplitude) / np.maximum(1e-9, 1 - amplitude), inside


def _turned(pane: scene_pb2.Glazing.Pane) -> scene_pb2.Glazing.Pane:
    """As it is from the other side."""
    match pane.WhichOneof("kind"):
        case "sheet":
            sheet = pane.sheet
            return scene_pb2.Glazing.Pane(
                sheet=scene_pb2.Glazing.Sheet(
                    index=sheet.index, transmittance=sheet.transmittance, front=sheet.back, back=sheet.front
                )
            )
        case "film":
            return scene_pb2.Glazing.Pane(film=scene_pb2.Glazing.Film(layers=list(pane.film.layers)[::-1]))
    measured = pane.measured
    return scene_pb2.Glazing.Pane(
        measured=scene_pb2.Glazing.Measured(
            front=measured.back, back=measured.front, transmittance=measured.transmittance
        )
    )
