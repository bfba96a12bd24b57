"""Radiation configuration factors: the part of the light from one diffuse surface that reaches another.

Howell, A Catalog of Radiation Heat Transfer Configuration Factors (C-41 discs, C-11 and C-14 rectangles,
C-127 sphere and disc); the numbers are those closed forms evaluated to eight digits.

The receiver is read by three methods that must agree: as an irradiance meter's film, by adjoint and by
forward photons (behind a black plane with a round opening where the receiver is a disc), and as a white
surface that a camera looks at, which aims at the lamp and so sees smaller faults. That all read the same is
the reciprocity A1 F12 = A2 F21.
"""

from dataclasses import dataclass
from math import pi
from pathlib import Path

import pytest
from nocturne_scene.validation.documents import (
    diffuse,
    disc,
    film,
    measured_scene,
    quad,
    ring,
    sphere,
    surface,
)

from tests.accuracy.meters import Measurement, Reading, check_equal
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_UNCERTAINTY = 2e-5
"""Of a factor: polygons for circles (6e-6 of an area), and a film 4e-6 off its plane, per metre."""

_GAP = 1e-4
"""Of the opening's radius: how far behind it the film is. Light that gets past is at 0.01 degrees."""


@dataclass(frozen=True)
class _Case:
    factor: float
    lamp: Document
    lamp_area: float
    receiver: Document
    camera: Document
    """Sees the receiver and as much around it that its film is `camera_area`."""
    camera_area: float
    meter: Document
    meter_area: float
    openings: tuple[Document, ...] = ()
    pixels: tuple[int, int] = (1, 1)


# A lamp of radiance 1 / pi has the exitance 1, so its flux is its area.
def _to_disc(factor: float, lamp: Document, lamp_area: float, radius: float) -> _Case:
    """A disc at z = 0 that faces up."""
    edge = 2.1 * radius
    return _Case(
        factor,
        surface(lamp, radiance=1.0 / pi),
        lamp_area,
        disc([0, 0, 0], [0, 0, 1], radius),
        _camera([0, 0, 0.1 * radius], [0, 0, 0], 2.0 * radius),
        4.0 * radius**2,
        film([0, 0, -_GAP * radius], [0, 0, 1], edge),
        edge**2,
        (surface(ring(radius, 3.0 * radius, 0.0)),),
    )


def _discs(factor: float, r1: float, r2: float, distance: float) -> _Case:
    return _to_disc(factor, disc([0, 0, distance], [0, 0, -1], r1), pi * r1**2, r2)


def _sphere_and_disc(factor: float, radius: float, distance: float, disc_radius: float) -> _Case:
    return _to_disc(factor, sphere([0, 0, distance], radius), 4.0 * pi * radius**2, disc_radius)


def _parallel(factor: float, width: int, distance: float) -> _Case:
    """Rectangles of `width` x 1."""
    corner = [-width / 2, -0.5, distance]
    return _Case(
        factor,
        surface(quad(corner, [0, 1, 0], [width, 0, 0]), radiance=1.0 / pi),
        width,
        quad([-width / 2, -0.5, 0], [width, 0, 0], [0, 1, 0]),
        _camera([0, 0, 0.1], [0, 0, 0], 1.0),
        width,
        film([0, 0, 0], [0, 0, 1], 1.0, up=[0, 1, 0]),
        width,
        pixels=(width, 1),
    )


def _perpendicular(factor: float, width: float, height: int) -> _Case:
    """The common edge, of length 1, is along y; the lamp is at z = 0, the receiver at x = 0."""
    return _Case(
        factor,
        surface(quad([0, -0.5, 0], [width, 0, 0], [0, 1, 0]), radiance=1.0 / pi),
        width,
        quad([0, -0.5, 0], [0, 1, 0], [0, 0, height]),
        _camera([0.1, 0, height / 2], [0, 0, height / 2], height, [0, 0, 1]),
        height,
        film([0, 0, height / 2], [1, 0, 0], height, up=[0, 0, 1]),
        height,
        pixels=(1, height),
    )


def _camera(
    position: list[float], look_at: list[float], height: float, up: list[float] | None = None
) -> Document:
    up = up or [0, 1, 0]
    return {"type": "orthographic", "position": position, "look_at": look_at, "up": up, "height": height}


_CASES = {
    "discs 1 1 1": _discs(0.38196601, 1.0, 1.0, 1.0),
    "discs 1 2 0.25": _discs(0.97972605, 1.0, 2.0, 0.25),
    "discs 0.1 0.1 3": _discs(0.0011086488, 0.1, 0.1, 3.0),
    "discs 0.5 1 0.5": _discs(0.76393202, 0.5, 1.0, 0.5),
    "parallel 1 1": _parallel(0.1998249, 1, 1.0),
    "parallel 2 0.5": _parallel(0.50898867, 2, 0.5),
    "parallel 1 10": _parallel(0.0031620568, 1, 10.0),
    "perpendicular 1 1": _perpendicular(0.20004378, 1.0, 1),
    "perpendicular 2 1": _perpendicular(0.1164263, 2.0, 1),
    "perpendicular 0.5 3": _perpendicular(0.31960896, 0.5, 3),
    # The factor does not depend on the sphere's radius, the first length.
    "sphere 0.3 2 1": _sphere_and_disc(0.052786405, 0.3, 2.0, 1.0),
    "sphere 1.5 2 1": _sphere_and_disc(0.052786405, 1.5, 2.0, 1.0),
    "sphere 0.3 5 0.5": _sphere_and_disc(0.0024814049, 0.3, 5.0, 0.5),
    "sphere 1 1.5 1": _sphere_and_disc(0.083974853, 1.0, 1.5, 1.0),
}


def _read(case: _Case, document: Document, folder: Path, samples: int) -> Reading:
    folder.mkdir()
    return Measurement(document, folder, *case.pixels).by_seeds(samples)


@pytest.mark.parametrize("case", _CASES.values(), ids=_CASES.keys())
def test_all_ways_read_the_factor(case: _Case, tmp_path: Path) -> None:
    """False alarms: 0.01 for each factor."""
    scene = [*case.openings, case.lamp]
    to_part = case.meter_area / case.lamp_area
    adjoint = _read(case, measured_scene(case.meter, scene), tmp_path / "adjoint", 1024) * to_part
    forward = (
        _read(case, measured_scene(case.meter, scene, direction="forward"), tmp_path / "forward", 4096)
        * to_part
    )
    white = measured_scene(case.camera, [surface(case.receiver, diffuse(1.0)), case.lamp])
    seen = _read(case, white, tmp_path / "seen", 4096) * (pi * case.camera_area / case.lamp_area)
    for reading in (adjoint, forward, seen):
        reading.check(case.factor, _UNCERTAINTY, values=4)
    check_equal(adjoint, forward, _UNCERTAINTY, values=4)
