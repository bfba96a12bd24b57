"""Kernels at the ends of their ranges."""

from math import pi

from tests.accuracy.tracing import Document
from tests.stability.build import BLACK, beam, box, diffuse, fresnel, lit, quad, surface, walls
from tests.stability.build import film as meter
from tests.stability.case import Case

_LEVEL = quad([-10, -10, 0], [20, 0, 0], [0, 20, 0])


def _metal(alpha: float, allowed: float) -> Case:
    n, k = 0.2, 3.4
    metal = {"type": "conductor", "index": {"n": n, "k": k}, "roughness": alpha}
    return Case(
        f"metal, alpha {alpha:g}",
        "facets that are all but a mirror",
        lit(beam(0.0), [surface(_LEVEL, metal)]),
        ((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k),
        "Fresnel at normal incidence; facets change it by about alpha squared",
        allowed=allowed,
    )


def _rough_glass(alpha: float) -> Case:
    glass = {"type": "dielectric", "index": 1.5, "roughness": alpha}
    plate = surface(box([-10, -10, -1], [10, 10, 0]), glass)
    return Case(
        f"glass plate, alpha {alpha:g}",
        "facets that are all but smooth, on both faces",
        lit(beam(0.0), [plate, _ceiling()]),
        2.0 * 1.5 / (1.5**2 + 1.0),
        "all inner reflections of a clear plate: 2 n / (n^2 + 1)",
        allowed=1e-4,
    )


def _mirror_at(degrees: float, index: float) -> Case:
    """A body that absorbs all light that it transmits."""
    glass = {"type": "dielectric", "index": index, "absorption": 1e3}
    plate = surface(box([-50, -50, -50], [50, 50, 0]), glass)
    return Case(
        f"glass of index {index:g} at {degrees:g} degrees",
        "what a surface reflects, all but edge-on",
        lit(beam(degrees, 1e-6), [plate]),
        fresnel(degrees, index),
        "Fresnel",
        allowed=1e-3,
        remedy="geometry in single precision: the angle itself is not exact",
    )


def _coat(degrees: float) -> Case:
    tile = {"type": "coated_diffuse", "index": 1.5, "reflectance": 1.0}
    return Case(
        f"white tile at {degrees:g} degrees",
        "a coat over a base of albedo 1",
        lit(beam(degrees, 1e-4), [surface(_LEVEL, tile)]),
        1.0,
        "nothing is absorbed, so it can't be seen in even light",
    )


def _phong() -> Case:
    shiny = {"type": "phong", "reflectance": 0.7, "exponent": 1e6}
    return Case(
        "cosine lobe, exponent 1e6",
        "a lobe 0.1 degrees wide",
        lit(beam(0.0), [surface(_LEVEL, shiny)]),
        0.7 * (1e6 + 2.0) / (1e6 + 2.0),
        "integral of the lobe times the cosine, at normal incidence",
        allowed=1e-4,
    )


def _mask() -> Case:
    veil: Document = {"type": "mask", "kernel": BLACK, "opacity": 1e-6}
    sheets = [surface(quad([-10, -10, -0.1 * i], [20, 0, 0], [0, 20, 0]), veil) for i in range(8)]
    return Case(
        "eight veils of opacity 1e-6",
        "surfaces that are all but not there",
        lit(beam(0.0), sheets),
        1.0,
        "nothing but 8e-6 is absorbed",
        allowed=1e-4,
    )


def _white_box(albedo: float, depth: int | None) -> Case:
    """Light from one wall; the others scatter, for a very long time."""
    document = lit(meter([0.5, 0.5, 0.5], [0, 0, 1], 0.5), walls([0, 0, 0], 1.0, diffuse(albedo), 1.0), None)
    if depth:
        document["tracing"] = {"maximum_depth": depth}
    return Case(
        f"box of albedo {albedo:g}" + (f", depth {depth}" if depth else ""),
        "light that scatters a thousand times",
        document,
        pi / (1.0 - albedo),
        "energy balance: irradiance pi L / (1 - albedo) in a closed box",
        samples=4 if albedo > 0.99 else 32,
        remedy="none given: paths have no limit; one that is set in $.tracing.maximum_depth is missing light",
    )


def _ceiling() -> Document:
    return surface(quad([-1e4, -1e4, 3.0], [2e4, 0, 0], [0, 2e4, 0]))


CASES = [
    _metal(0.0, 2e-5),
    _metal(1e-6, 1e-4),
    _metal(1e-4, 1e-4),
    _metal(1e-2, 1e-3),
    *map(_rough_glass, (1e-6, 1e-4)),
    _mirror_at(89.0, 1.5),
    _mirror_at(89.9, 1.5),
    _mirror_at(89.0, 1.0001),
    _coat(0.0),
    _coat(89.9),
    _phong(),
    _mask(),
    _white_box(0.99, None),
    _white_box(0.999, None),
    _white_box(0.999, 20000),
]
