"""The inverse-square law: point sources, area sources as they become points, and lamps with a profile."""

from collections.abc import Iterator
from math import cos, pi, radians, sin

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import Document, disc, film, sphere

_LAW = "inverse-square and cosine law, E = I cos / d^2 (J. H. Lambert, Photometria, 1760)"
_DISC = "E = pi L r^2 / (r^2 + d^2) (CIE 171:2006, 5.3; Howell B-12)"
_PROFILE = "I = I0 cos^n; flux 2 pi I0 / (n + 1)"


def scenes() -> Iterator[Scene]:
    """Of 1000 lm, on a film that faces the lamp or is turned away from it."""
    for distance in (0.5, 1.0, 2.0, 5.0, 20.0, 100.0):
        for tilt in (0, 40, 70):
            meter = film([0, 0, 0], [sin(radians(tilt)), 0.0, cos(radians(tilt))], 1e-5)
            lamp = _lamp(sphere([0, 0, distance], 0.01))
            truth = 1000.0 / (4.0 * pi) / distance**2 * cos(radians(tilt))
            yield _scene(f"point source, {distance:g} m, {tilt} deg, lx", _LAW, truth, meter, lamp)
    for ratio in (1.0, 2.0, 5.0, 10.0):
        # Distance over the lamp's diameter: at 5 the square law is off by 1 %.
        lamp = _lamp(disc([0, 0, ratio], [0, 0, -1], 0.5))
        truth = 1000.0 / pi / (0.25 + ratio**2)
        yield _scene(
            f"disc, {ratio:g} diameters away, lx", _DISC, truth, film([0, 0, 0], [0, 0, 1], 1e-5), lamp
        )
    for power in (0.0, 1.0, 4.0, 20.0):
        for degrees in (0, 20, 45):
            place = [3.0 * sin(radians(degrees)), 0.0, 5.0 - 3.0 * cos(radians(degrees))]
            meter = film(place, [-x for x in place[:2]] + [5.0 - place[2]], 1e-5)
            lamp = _lamp(disc([0, 0, 5], [0, 0, -1], 0.005), {"cosine_power": power})
            # The radiance falls as cos^n, the intensity as cos^(n + 1).
            truth = 1000.0 * (power + 2.0) / (2.0 * pi) * cos(radians(degrees)) ** (power + 1.0) / 9.0
            yield _scene(f"cosine power {power:g} at {degrees} deg, lx", _PROFILE, truth, meter, lamp)


def _lamp(shape: Document, profile: Document | None = None) -> Document:
    luminaire = {"radiance": 1.0, "lumens": 1000.0} | ({"profile": profile} if profile else {})
    return {"shape": shape, "kernel": {"type": "lambertian", "reflectance": 0}, "luminaire": luminaire}


def _scene(name: str, source: str, truth: float, meter: Document, lamp: Document) -> Scene:
    return Scene({"nocturne": 1, "sensor": meter, "surfaces": [lamp]}, (Value(name, truth, source, "Y"),))
