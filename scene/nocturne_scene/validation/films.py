"""Thin films: coated glass and metal, films alone, coated panes, by characteristic matrices."""

from collections.abc import Iterator
from math import radians, sin
from typing import Any

import numpy as np

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import (
    RANGE_NM,
    Document,
    along,
    measured_scene,
    quad,
    screen,
    surface,
)
from nocturne_scene.validation.stacks import Floats, Layer, Sheet, one_behind_other, polarised, unpolarised

_ABELES = "F. Abeles, Annales de Physique 12, 1950: characteristic matrices"
_QUARTER = "H. A. Macleod, Thin-Film Optical Filters: ((n0 ns - n1^2) / (n0 ns + n1^2))^2 along the normal"
_EN410 = "EN 410:2011, section 5.2, from panes by Abeles' matrices"
_EN410_MEASURED = "EN 410:2011, section 5.2, of numbers"

_GLASS = 1.5168
_MGF2: list[Layer] = [(1.38 + 0j, 550 / (4 * 1.38))]
_MIRROR: list[Layer] = [*[(2.35 + 0j, 58.5), (1.38, 99.6)] * 3, (2.35, 58.5)]
_LOW_E: list[Layer] = [(2.0, 40.0), (0.06 + 3.6j, 12.0), (2.0, 35.0)]
_STACKS: dict[str, list[Layer]] = {
    "MgF2": _MGF2,
    "mirror of seven layers": _MIRROR,
    "silver between oxides": _LOW_E,
}
_METALS: dict[str, tuple[list[Layer], complex]] = {
    "silver under silica": ([(1.46, 250.0)], 0.06 + 3.6j),
    "chromium": ([(2.2, 45.0)], 3.2 + 3.3j),
}

_WAVELENGTHS = np.arange(360.0, 830.05, 0.1)


def scenes() -> Iterator[Scene]:
    """At one wavelength, then of light that is even from 360 to 830 nm."""
    for degrees in (0, 45, 60):
        known = float(unpolarised(np.array([550.0]), degrees, _MGF2, _GLASS)[0][0])
        value = Value(f"MgF2 on glass at 550 nm, {degrees} deg", known, _QUARTER if degrees == 0 else _ABELES)
        line: Any = {"lines": [{"nm": 550.0, "power": RANGE_NM, "width": 0.01}]}
        yield _lit(along(degrees, 1.0), [_body(_MGF2), _below()], value, line, wavelengths="response")
    for name, layers in _STACKS.items():
        for degrees in (0, 30, 60, 80):
            known = _mean(unpolarised(_WAVELENGTHS, degrees, layers, _GLASS)[0])
            value = Value(f"{name} on glass, {degrees} deg: reflectance", known, _ABELES)
            yield _lit(along(degrees, 1.0), [_body(layers), _below()], value)
        for degrees in (0, 60):
            through = _mean(_plate(layers, degrees))
            value = Value(f"plate with {name} on both faces, {degrees} deg: through", through, _ABELES)
            yield _lit(along(degrees, 1.0), [_body(layers, half_edge=20.0), screen(100.0, 1e6, 0.0)], value)
    for name, (layers, index) in _METALS.items():
        for degrees in (0, 60, 80):
            known = _mean(unpolarised(_WAVELENGTHS, degrees, layers, index)[0])
            kernel = {
                "type": "conductor",
                "index": {"n": index.real, "k": index.imag},
                "coating": _written(layers),
            }
            metal = {"shape": quad([-9, -9, 0], [18, 0, 0], [0, 18, 0]), "kernel": kernel}
            yield _lit(along(degrees, 1.0), [metal], Value(f"{name}, {degrees} deg", known, _ABELES))
    for degrees in (0, 45, 70):
        soap: list[Layer] = [(1.33, 400.0)]
        known = _mean(unpolarised(_WAVELENGTHS, degrees, soap, 1.0)[0])
        value = Value(f"soap film of 400 nm, {degrees} deg: reflectance", known, _ABELES)
        yield _window([{"film": _written(soap)}], degrees, value, back=True)
    yield from _windows()


def _windows() -> Iterator[Scene]:
    clear = {"front_reflectance": 0.083, "back_reflectance": 0.083, "transmittance": 0.899}
    coated = {"front_reflectance": 0.05, "back_reflectance": 0.11, "transmittance": 0.78}
    first, second = (
        tuple(np.array([pane[key]]) for key in ("front_reflectance", "back_reflectance", "transmittance"))
        for pane in (coated, clear)
    )
    both = one_behind_other(first, second)  # type: ignore[arg-type]
    for name, truth in (("through", both[2]), ("reflectance", both[0])):
        value = Value(f"two measured panes: {name}", float(truth[0]), _EN410_MEASURED)
        yield _window([coated, clear], 0, value, back=name == "reflectance")
    inner: Document = {"index": 1.52, "front": _written(_LOW_E)}
    for degrees in (0, 40, 70):
        shares = [
            one_behind_other(_sheet([], degrees, way), _sheet(_LOW_E, degrees, way)) for way in ("s", "p")
        ]
        for name, part in (("through", 2), ("reflectance", 0)):
            known = _mean(shares[0][part] + shares[1][part]) / 2
            value = Value(f"clear pane before one with silver, {degrees} deg: {name}", known, _EN410)
            yield _window([{"index": 1.52}, inner], degrees, value, back=name == "reflectance")


def _sheet(front: list[Layer], degrees: float, way: str) -> Sheet:
    """Of index 1.52, its back bare."""
    index, inside = 1.52, float(np.degrees(np.arcsin(sin(radians(degrees)) / 1.52)))
    outer, through = polarised(_WAVELENGTHS, degrees, front, index)[way]
    inner = polarised(_WAVELENGTHS, inside, front[::-1], 1.0, index)[way][0]
    back_outer, back_through = polarised(_WAVELENGTHS, degrees, [], index)[way]
    return one_behind_other((outer, inner, through), (back_outer, back_outer, back_through))


def _plate(layers: list[Layer], degrees: float) -> Floats:
    """Through a body with the same layers on both faces, unpolarised at every bounce."""
    inside = float(np.degrees(np.arcsin(sin(radians(degrees)) / _GLASS)))
    through = unpolarised(_WAVELENGTHS, degrees, layers, _GLASS)[1]
    back = unpolarised(_WAVELENGTHS, inside, layers[::-1], 1.0, _GLASS)[0]
    return through**2 / (1 - back**2)


def _mean(values: Floats) -> float:
    return float(np.trapezoid(values, _WAVELENGTHS) / (_WAVELENGTHS[-1] - _WAVELENGTHS[0]))


def _written(layers: list[Layer]) -> list[Document]:
    def index(n: complex) -> float | Document:
        return {"n": n.real, "k": n.imag} if n.imag else n.real

    return [{"index": index(complex(n)), "thickness_nm": thickness} for n, thickness in layers]


def _body(layers: list[Layer], half_edge: float = 1e3) -> Document:
    shape = {"type": "box", "minimum": [-half_edge, -half_edge, -1.0], "maximum": [half_edge, half_edge, 0.0]}
    return {
        "shape": shape,
        "kernel": {"type": "dielectric", "index": _GLASS, "coating": _written(layers)},
    }


def _below() -> Document:
    return surface(quad([-999, -999, -0.5], [1998, 0, 0], [0, 1998, 0]))


def _window(panes: list[Document], degrees: float, value: Value, *, back: bool) -> Scene:
    """Across the z axis, its front upwards; `back`: light from above."""
    window = {
        "shape": quad([-20, -20, 0], [40, 0, 0], [0, 40, 0]),
        "kernel": {"type": "glazing", "panes": panes},
    }
    return _lit(along(degrees, 1.0), [window, screen(-100.0 if back else 100.0, 1e6, 0.0)], value)


def _lit(sensor: Document, surfaces: list[Document], value: Value, radiance: Any = 1.0, **more: Any) -> Scene:
    document = measured_scene({**sensor, **more}, surfaces)
    return Scene(document | {"environment": {"radiance": radiance}}, (value,), 2**16)
