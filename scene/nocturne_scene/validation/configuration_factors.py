"""Configuration factors: the part of the light from one diffuse surface that reaches another."""

from collections.abc import Iterator
from math import cos, pi, radians, sin

from nocturne_scene.validation import closed_forms as forms
from nocturne_scene.validation.cases import Scene, Value
from nocturne_scene.validation.documents import (
    Document,
    disc,
    film,
    measured_scene,
    quad,
    ring,
    sphere,
    surface,
)

_GAP = 1e-4
"""Of an opening's radius: how far behind it the film is."""

_CATALOG = 'J. R. Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", {}'


def scenes() -> Iterator[Scene]:
    """Between surfaces, and from a small film. A lamp of radiance 1 / pi has the exitance 1."""
    yield from _discs()
    yield from _rectangles()
    yield from _points()


def _discs() -> Iterator[Scene]:
    """The second disc is a round opening in a black plane, with a film behind it."""
    for first in (0.25, 1.0, 3.0):
        for second in (0.5, 1.0, 2.0):
            for distance in (0.5, 1.0, 4.0):
                lamp = disc([0, 0, distance], [0, 0, -1], first)
                truth = forms.coaxial_discs(first, second, distance)
                name = f"discs of radii {first:g} and {second:g}, {distance:g} apart"
                yield _through_opening(name, "C-41", truth, lamp, pi * first**2, second)
    for radius, distance, opening in ((0.3, 2, 1), (1.5, 2, 1), (0.3, 5, 0.5), (1, 1.5, 1), (0.5, 1, 2)):
        lamp = sphere([0, 0, distance], radius)
        truth = forms.sphere_to_disc(distance, opening)
        name = f"sphere of radius {radius:g} and disc of {opening:g}, {distance:g} apart"
        yield _through_opening(name, "sphere and disc", truth, lamp, 4.0 * pi * radius**2, opening)


def _through_opening(
    name: str, which: str, truth: float, lamp: Document, lamp_area: float, radius: float
) -> Scene:
    edge = 2.1 * radius
    meter = film([0, 0, -_GAP * radius], [0, 0, 1], edge)
    plane = surface(ring(radius, 3.0 * radius, 0.0))
    document = measured_scene(meter, [plane, surface(lamp, radiance=1.0 / pi)])
    return Scene(document, (Value(name, truth, _CATALOG.format(which), factor=edge**2 / lamp_area),))


def _rectangles() -> Iterator[Scene]:
    for width in (1, 2, 4):
        for distance in (0.3, 1.0, 3.0, 10.0):
            lamp = quad([-width / 2, -0.5, distance], [0, 1, 0], [width, 0, 0])
            name = f"parallel rectangles of 1 x {width}, {distance:g} apart"
            truth = forms.parallel_rectangles(width, 1.0, distance)
            document = measured_scene(film([0, 0, 0], [0, 0, 1], 1.0), [surface(lamp, radiance=1.0 / pi)])
            yield Scene(document, (Value(name, truth, _CATALOG.format("C-11")),), 2**17 // width, (width, 1))
    for across in (0.25, 0.5, 1.0, 3.0):
        for height in (1, 2, 3):
            lamp = quad([0, -0.5, 0], [across, 0, 0], [0, 1, 0])
            name = f"perpendicular rectangles of 1 x {across:g} and 1 x {height}"
            truth = forms.perpendicular_rectangles(across, height, 1.0)
            meter = film([0, 0, height / 2], [1, 0, 0], height, up=[0, 0, 1])
            document = measured_scene(meter, [surface(lamp, radiance=1.0 / pi)])
            value = Value(name, truth, _CATALOG.format("C-14"), factor=height / across)
            yield Scene(document, (value,), 2**17 // height, (1, height))


def _points() -> Iterator[Scene]:
    """From a small film to lamps: the illuminance over the lamp's exitance."""
    for radius, height in ((0.01, 3.0), (0.1, 1.0), (0.5, 1.0), (1.0, 1.0), (3.0, 1.0)):
        for aside in (0.0, 0.7, 2.0):
            lamp = disc([aside, 0, height], [0, 0, -1], radius)
            which = "B-13" if aside else "B-12"
            name = f"point to disc of radius {radius:g}, {height:g} above, {aside:g} aside"
            yield _point(name, which, forms.point_to_disc(radius, height, aside), lamp)
    for a, b, c in ((1, 1, 1), (2, 1, 1), (3, 0.5, 2), (0.1, 0.1, 1), (5, 5, 1)):
        corners = [[0.0, 0.0, c], [0.0, b, c], [a, b, c], [a, 0.0, c]]
        truth = forms.point_to_polygon([0, 0, 0], [0, 0, 1], corners)
        name = f"point below the corner of {a:g} x {b:g}, {c:g} above"
        yield _point(name, "B-4", truth, quad([0, 0, c], [0, b, 0], [a, 0, 0]))
        corners = [[c, 0.0, 0.0], [c, b, 0.0], [c, b, a], [c, 0.0, a]]
        truth = forms.point_to_polygon([0, 0, 0], [0, 0, 1], corners)
        name = f"point before the lower corner of {b:g} x {a:g}, {c:g} away"
        yield _point(name, "B-5", truth, quad([c, 0, 0], [0, 0, a], [0, b, 0]))
    for radius, distance, tilt in (
        (1.0, 2.0, 0),
        (0.5, 2.0, 30),
        (0.5, 2.0, 60),
        (0.05, 5.0, 45),
        (1.9, 2.0, 0),
    ):
        truth = (radius / distance) ** 2 * cos(radians(tilt))
        normal = [sin(radians(tilt)), 0.0, cos(radians(tilt))]
        name = f"point to sphere of radius {radius:g}, {distance:g} away, at {tilt} deg"
        yield _point(name, "point and sphere", truth, sphere([0, 0, distance], radius), normal)


def _point(name: str, which: str, truth: float, lamp: Document, normal: list[float] | None = None) -> Scene:
    meter = film([0, 0, 0], normal or [0.0, 0.0, 1.0], 1e-5)
    document = measured_scene(meter, [surface(lamp, radiance=1.0 / pi)])
    return Scene(document, (Value(name, truth, _CATALOG.format(which)),))
