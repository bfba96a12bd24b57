"""Scenes that must be refused."""

from collections.abc import Callable
from math import inf, nan

from tests.accuracy.tracing import Document
from tests.stability.build import beam, diffuse, furnace, lit, quad, surface
from tests.stability.case import Case


def _refused(name: str, change: Callable[[Document], None]) -> Case:
    document = furnace(0.5)
    change(document)
    return Case(name, "input that means nothing", document, None, "an error that names the place")


def _vertex(value: float) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        document["surfaces"][0]["shape"]["corner"][0] = value

    return change


def _radiance(value: float) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        document["surfaces"][0]["luminaire"]["radiance"] = value

    return change


def _albedo(value: float) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        document["surfaces"][0]["kernel"] = diffuse(value)

    return change


def _line_g(document: Document) -> None:
    medium = {"scattering": 1.0, "phase": {"type": "henyey_greenstein", "g": 1.0}}
    document |= {"media": {"fog": medium}, "unbounded_media": ["fog"]}


def _flat(document: Document) -> None:
    document["surfaces"][0]["shape"]["edge_u"] = document["surfaces"][0]["shape"]["edge_v"]


def _dark(document: Document) -> None:
    for wall in document["surfaces"]:
        wall.pop("luminaire", None)


def _tiny() -> Case:
    small = lit(beam(0.0), [surface(quad([0, 0, 0], [1e-9, 0, 0], [0, 1e-9, 0]), diffuse(0.5))])
    return Case("square of 1e-9 m", "too small for the rays", small, None, "an error that names the place")


CASES = [
    _refused("corner that is not a number", _vertex(nan)),
    _refused("corner at infinity", _vertex(inf)),
    _refused("corner at 1e38 m", _vertex(1e38)),
    _refused("radiance that is not a number", _radiance(nan)),
    _refused("radiance of 1e38", _radiance(1e38)),
    _refused("negative radiance", _radiance(-1.0)),
    _refused("albedo of 1.5", _albedo(1.5)),
    _refused("phase function of g = 1", _line_g),
    _refused("square without an area", _flat),
    _refused("scene without light", _dark),
    _tiny(),
]
