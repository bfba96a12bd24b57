"""Media: thick, forward, in layers, in each other, all but not there."""

from math import exp, pi
from typing import Any

from nocturne_scene.validation.documents import sphere

from tests.accuracy.tracing import Document
from tests.stability import second
from tests.stability.build import beam, box, diffuse, lit, quad, surface
from tests.stability.case import Case

_WHITE = "nothing is absorbed, so it can't be seen in even light"


def _medium(albedo: float, g: float = 0.0, extinction: float = 1.0, **more: Any) -> Document:
    made: Document = {"scattering": albedo * extinction, "absorption": (1.0 - albedo) * extinction}
    phase = {"type": "henyey_greenstein", "g": g}
    return made | ({"phase": phase} if g and albedo else {}) | more


def _slab(
    media: Document, thickness: float, sensor: Document, half: float, dark: bool = True, scale: float = 1.0
) -> Document:
    """Across the z axis from 0 down; light from everywhere, or from below."""
    shape = box([-half, -half, -thickness], [half, half, 0.0])
    surfaces: list[Document] = [{"shape": shape, "interior": {"media": list(media)}}]
    if dark:
        wide = 1e4 * scale
        surfaces.append(surface(quad([-wide, -wide, 3.0 * scale], [2 * wide, 0, 0], [0, 2 * wide, 0])))
    return lit(sensor, surfaces, media=media)


def _forward(g: float) -> Case:
    truth, error = second.slab(0.9, g, 2.0)
    return Case(
        f"slab of g = {g:g}",
        f"a phase function that is all but {'a line' if abs(g) > 0.9 else 'even'}",
        _slab({"fog": _medium(0.9, g)}, 2.0, beam(0.0), 50.0),
        truth,
        "random walks in a slab without geometry, in double precision",
        allowed=4.0 * error / truth + 2e-4,
    )


def _van_de_hulst(scale: float) -> Case:
    fog = _medium(0.9, 0.75, 1.0 / scale)
    sensor = beam(0.0, 1e-3 * scale, scale)
    return Case(
        f"fog on a scale of {scale:g} m",
        "a free path of that length, and all else in proportion",
        _slab({"fog": fog}, 2.0 * scale, sensor, 50.0 * scale, scale=scale),
        0.6609577,
        "van de Hulst, Multiple Light Scattering, 1980",
        allowed=2e-4,
    )


def _thick(thickness: float, samples: int) -> Case:
    return Case(
        f"white slab of optical thickness {thickness:g}",
        "a photon scatters twice as often as that",
        _slab({"milk": _medium(1.0)}, thickness, beam(0.0), 10.0 * thickness, dark=False),
        1.0,
        _WHITE,
        samples=samples,
    )


def _through() -> Case:
    return Case(
        "through a white slab of optical thickness 50",
        "photons that diffuse: 3 % come through",
        _slab({"milk": _medium(1.0)}, 50.0, beam(0.0), 1000.0),
        0.032648698,
        "asymptotic theory, error exp(-50)",
        allowed=2e-3,
        samples=512,
        remedy="more samples: 30 of 31 photons turn back",
    )


def _spike() -> Case:
    """A million times as dense within a thousandth of the height."""
    layers = [[-1.0, 1e-6], [-0.501, 1e-6], [-0.5, 1e3], [-0.499, 1e-6], [0.0, 1e-6]]
    fog = _medium(0.0, density={"layers": layers, "above": {"point": [0, 0, 0], "up": [0, 0, 1]}})
    return Case(
        "layer of contrast 1e9",
        "a density that rises from 1e-6 to 1e3 within a millimetre",
        _slab({"fog": fog}, 1.0, beam(0.0), 5.0),
        exp(-1.0),
        "Beer and Lambert: exp(-1)",
        allowed=1e-4,
        remedy="ray marching needs steps shorter than the layer",
    )


def _overlap() -> Case:
    """Two boxes, each thicker than the other along one half of the path."""
    media = {"a": _medium(0.0, extinction=1.0), "b": _medium(0.0, extinction=2.0)}
    surfaces: list[Document] = [
        {"shape": box([-5, -5, -1.0], [5, 5, 0.0]), "interior": {"media": ["a"]}},
        {"shape": box([-5, -5, -1.5], [5, 5, -0.5]), "interior": {"media": ["b"]}},
        surface(quad([-1e4, -1e4, 3.0], [2e4, 0, 0], [0, 2e4, 0])),
    ]
    return Case(
        "media that overlap by half",
        "two absorbing bodies in each other",
        lit(beam(0.0), surfaces, media=media),
        exp(-3.0),
        "Beer and Lambert: coefficients add up, exp(-3)",
        allowed=1e-4,
    )


def _extinction(sigma: float, truth: float) -> Case:
    return Case(
        f"absorption of {sigma:g} in a metre",
        "optical depths at the ends of the range",
        _slab({"ink": _medium(0.0, extinction=sigma)}, 1.0, beam(0.0), 5.0),
        truth,
        "Beer and Lambert",
        allowed=1e-4,
    )


def _in_fog() -> Case:
    """The camera is in the middle of an absorbing ball."""
    camera = {
        "type": "pinhole",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "vertical_field_of_view_degrees": 60,
    }
    ball: Document = {"shape": sphere([0, 0, 0], 1.0), "interior": {"media": ["ink"]}}
    return Case(
        "camera inside a medium",
        "the sensor is in the middle of an absorbing ball",
        lit(camera, [ball], media={"ink": _medium(0.0)}),
        exp(-1.0),
        "Beer and Lambert: exp(-1)",
        allowed=1e-4,
    )


def _lamp_in_fog() -> Case:
    """Fog without end, which only absorbs, above a small white tile."""
    lamp = surface(sphere([0, 0, 1], 1e-3), radiance=1e6 / pi)
    tile = surface(quad([-0.01, -0.01, 0], [0.02, 0, 0], [0, 0.02, 0]), diffuse(1.0))
    document = lit(beam(45.0), [lamp, tile], sky=None)
    document |= {"media": {"ink": _medium(0.0)}, "unbounded_media": ["ink"]}
    return Case(
        "lamp in absorbing fog without end",
        "a small lamp, seen by a white tile through one optical depth",
        document,
        exp(-2.0) / pi,
        "L r^2 / d^2 times exp(-d) to the tile, and exp(-d) to the camera",
        allowed=1.5e-3,
        samples=512,
    )


def _white_ball() -> Case:
    """A ball of milk in glass."""
    ball: Document = {
        "shape": sphere([0, 0, 0], 1.0),
        "kernel": {"type": "dielectric", "index": 1.4},
        "interior": {"media": ["milk"]},
    }
    return Case(
        "white milk in glass, optical thickness 100",
        "subsurface scattering without a loss",
        lit(beam(0.0, 1.9, 5.0), [ball], media={"milk": _medium(1.0, 0.9, 50.0)}),
        1.0,
        _WHITE,
        samples=64,
    )


CASES = [
    *map(_forward, (0.999, 0.99999, -0.999, 1e-4)),
    *map(_van_de_hulst, (1e-4, 1.0, 1e6)),
    _thick(1e2, 64),
    _thick(1e3, 16),
    _thick(1e4, 2),
    _through(),
    _spike(),
    _overlap(),
    _extinction(1e-20, 1.0),
    _extinction(1e20, 0.0),
    _in_fog(),
    _lamp_in_fog(),
    _white_ball(),
]
