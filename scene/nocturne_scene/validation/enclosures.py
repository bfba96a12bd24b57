"""Closed and nearly closed cavities: integrating spheres, concentric spheres, furnaces."""

from collections.abc import Iterator
from math import pi, sqrt

from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import (
    GREY,
    Document,
    diffuse,
    disc,
    film,
    furnace,
    measured_scene,
    sphere,
    surface,
)

INSIDE = 3e-5
"""How far inside of a wall a film is, part of the radius: more than the film's bulge and its stand-off."""

_SPHERE = "D. G. Goebel, Applied Optics 6, 1967: M = rho / (1 - rho (1 - f))"
_GOUFFE = "A. Gouffe, Revue d'Optique 24, 1945: e / (e (1 - f) + f)"
_CONCENTRIC = "two-surface enclosure: M. F. Modest, Radiative Heat Transfer, chapter 5"
_FURNACE = "energy balance: L = e / (1 - albedo)"


def lamp_of(centre: list[float], radius: float, watts: float) -> Document:
    """A sphere that light passes through, of this flux per nanometre."""
    return surface(sphere(centre, radius), {"type": "null"}, watts / (4.0 * pi**2 * radius**2))


def port(radius: float, fraction: float) -> tuple[float, float]:
    """Height above the centre and radius of the disc that cuts off this fraction of a sphere's area."""
    height = radius * (1.0 - 2.0 * fraction)
    return height, sqrt(radius**2 - height**2)


def integrating_sphere(
    radius: float, reflectance: float, fraction: float, lamp_radius: float = 0.3
) -> list[Document]:
    """With a lamp of 4 pi W / nm in the middle: it lights the wall evenly, whatever its radius."""
    surfaces = [
        surface(sphere([0, 0, 0], radius), diffuse(reflectance)),
        lamp_of([0, 0, 0], lamp_radius * radius, 4.0 * pi),
    ]
    if fraction:
        height, edge = port(radius, fraction)
        surfaces.append(surface(disc([0, 0, height], [0, 0, -1], edge)))
    return surfaces


def on_wall(radius: float, place: list[float]) -> Document:
    """A film on the inside of the wall; `place` is on the unit sphere."""
    centre = [(1.0 - INSIDE) * radius * x for x in place]
    return film(centre, [-x for x in place], 1e-5 * radius)


def scenes() -> Iterator[Scene]:
    """Indirect irradiance in spheres, radiosities, emissivities of cavities, and radiances in furnaces."""
    for reflectance in (0.3, 0.5, 0.8, 0.9, 0.95, 0.98):
        for fraction in (0.0, 0.01, 0.05):
            multiplier = reflectance / (1.0 - reflectance * (1.0 - fraction))
            document = measured_scene(
                on_wall(1.0, [0.0, 0.0, -1.0]), integrating_sphere(1.0, reflectance, fraction)
            )
            name = f"sphere multiplier, reflectance {reflectance:g}, ports {fraction:g}"
            direct = 1.0 / (1.0 - INSIDE) ** 2
            part = 1.0 / (1.0 - fraction)
            yield Scene(
                document, (Value(name, multiplier, _SPHERE, factor=part, plus=-direct * part),), 2**16
            )
    for emissivity in (0.3, 0.5, 0.9):
        for fraction in (0.02, 0.1, 0.3):
            height, edge = port(1.0, fraction)
            wall = surface(sphere([0, 0, 0], 1.0), diffuse(1.0 - emissivity), emissivity, two_sided=True)
            meter = film([0, 0, height], [0, 0, -1], edge)
            document = measured_scene(meter, [wall, surface(disc([0, 0, height], [0, 0, -1], edge))])
            truth = emissivity / (emissivity * (1.0 - fraction) + fraction)
            name = f"effective emissivity, wall {emissivity:g}, opening {fraction:g}"
            yield Scene(document, (Value(name, truth, _GOUFFE, factor=1.0 / pi),), 2**16)
    yield from _concentric()
    for albedo in (0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99):
        document = furnace(albedo, 1.0)
        document["sensor"] |= GREY
        value = Value(f"furnace, albedo {albedo:g}", 1.0 / (1.0 - albedo), _FURNACE)
        yield Scene(document, (value,), 2**15)
        camera = {
            "type": "pinhole",
            "vertical_field_of_view_degrees": 30.0,
            "position": [0.5, 0, 0],
            "look_at": [0.9, 0.1, 0.3],
        }
        document = measured_scene(camera, integrating_sphere(1.0, albedo, 0.0))
        value = Value(f"closed sphere, albedo {albedo:g}", albedo / (1.0 - albedo), _FURNACE, factor=pi)
        yield Scene(document, (value,), 2**15)


def _concentric() -> Iterator[Scene]:
    """Exitance 1 of the inner sphere; F12 = 1, F21 = (r1 / r2)^2, F22 = 1 - F21."""
    for inner, outer, rho_inner, rho_outer in (
        (1.0, 2.0, 0.5, 0.5),
        (1.0, 1.05, 0.9, 0.9),
        (0.5, 1.0, 0.3, 0.95),
        (0.2, 1.0, 0.8, 0.6),
    ):
        to_inner = (inner / outer) ** 2
        # b1 = 1 + r1 b2 (per area of the inner), b2 = r2 (F21 b1 + F22 b2)
        b_outer = (
            rho_outer * to_inner / (1.0 - rho_outer * (1.0 - to_inner) - rho_outer * to_inner * rho_inner)
        )
        b_inner = 1.0 + rho_inner * b_outer
        surfaces = [
            surface(sphere([0, 0, 0], inner), diffuse(rho_inner), 1.0 / pi),
            surface(sphere([0, 0, 0], outer), diffuse(rho_outer)),
        ]
        radii = f"radii {inner:g} and {outer:g}, reflectances {rho_inner:g} and {rho_outer:g}"
        for name, towards, truth in (
            ("inner", [0.02, 0.01, 0.0], b_inner),
            ("outer", [0.02, 0.01, 5.0], b_outer),
        ):
            meter = {
                "type": "radiance_meter",
                "position": [0.0, 0.0, (inner + outer) / 2],
                "look_at": towards,
                "diameter": 1e-4,
                "cone_degrees": 0.1,
            }
            value = Value(f"radiosity of the {name} sphere, {radii}", truth, _CONCENTRIC, factor=pi)
            yield Scene(measured_scene(meter, surfaces), (value,), 2**16)
