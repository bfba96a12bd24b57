"""Smooth glass: Fresnel's reflection by angle and of light from everywhere, and plates."""

from collections.abc import Iterator
from math import exp, pi

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.closed_forms import fresnel, plate
from nocturne_scene.validation.documents import Document, along, film, measured_scene, quad, screen, surface
from nocturne_scene.validation.truths import truths

_FRESNEL = "A. Fresnel 1823; M. Born and E. Wolf, Principles of Optics, 1.5"
_DUNTLEY = "Fresnel over the hemisphere; inside by S. Q. Duntley, JOSA 32, 1942"
_STOKES = "G. G. Stokes, Proceedings of the Royal Society 11, 1862, unpolarised at every bounce"

_WIDE = 1e3
_FAINT = 2e-3
"""Reflectances below are left out: too few photons are reflected for a normal mean."""


def scenes() -> Iterator[Scene]:
    """One face, then plates, as bodies and as panes without thickness."""
    for entry in truths("interfaces")["glass"]:
        index = entry["index"]
        if fresnel(index, 0.0) < _FAINT:
            continue
        glass = [_body(index), surface(_level(-0.5))]
        for degrees in (0, 30, 45, 60, 75, 85):
            name = f"reflectance, n {index:g}, {degrees} deg"
            yield _even(along(degrees, 1.0), glass, Value(name, fresnel(index, degrees), _FRESNEL))
        lamp = [_body(index), surface(_level(-0.5), radiance=1.0)]
        outside, inside = entry["outside"], entry["inside"]
        down, up = film([0, 0, 1e-2], [0, 0, -1], 1e-3), film([0, 0, -1e-2], [0, 0, 1], 1e-3)
        name = f"light from everywhere, n {index:g}: "
        yield _even(down, glass, Value(name + "reflected", outside, _DUNTLEY, factor=1.0 / pi))
        yield _even(up, glass, Value(name + "let in", 1.0 - outside, _DUNTLEY, factor=1.0 / pi))
        yield _even(up, lamp, Value(name + "reflected inside", inside, _DUNTLEY, factor=1.0 / pi), sky=False)
    for index, thickness in ((1.52, 0.0), (1.5168, 0.1), (1.8, 0.05)):
        for kind in ("body", "pane"):
            for degrees in (0, 20, 40, 60, 75, 85):
                through, back = plate(index, degrees, thickness)
                panes = [_plate(kind, index, thickness)]
                name = f"{kind}, n {index:g}, {thickness:g} free paths thick, {degrees} deg: "
                for side, truth in (("through", through), ("back", back)):
                    dark = screen(100.0 if side == "through" else -100.0, 1e6, 0.0)
                    value = Value(name + side, truth, _STOKES)
                    yield _even(along(degrees, 1.0), [*panes, dark], value)


def _level(z: float) -> Document:
    edge = 0.999 * _WIDE
    return quad([-edge, -edge, z], [2 * edge, 0, 0], [0, 2 * edge, 0])


def _body(index: float, bottom: float = -1.0, half_edge: float = _WIDE, absorption: float = 0.0) -> Document:
    shape = {
        "type": "box",
        "minimum": [-half_edge, -half_edge, bottom],
        "maximum": [half_edge, half_edge, 0.0],
    }
    kernel = {"type": "dielectric", "index": index} | ({"absorption": absorption} if absorption else {})
    return {"shape": shape, "kernel": kernel}


def _plate(kind: str, index: float, thickness: float) -> Document:
    if kind == "body":
        return _body(index, half_edge=20.0, absorption=thickness)
    kernel = {"type": "thin_pane", "index": index, "transmittance": exp(-thickness)}
    return {"shape": quad([-20, -20, 0], [40, 0, 0], [0, 40, 0]), "kernel": kernel}


def _even(sensor: Document, surfaces: list[Document], value: Value, sky: bool = True) -> Scene:
    document = measured_scene(sensor, surfaces)
    return Scene(document | ({"environment": {"radiance": 1.0}} if sky else {}), (value,), 2**16)
