"""A parabolic mirror with a glowing ball at its focus: intensity on the axis, and how far the beam
spreads.

On the axis every zone of the mirror shows the ball: I = L times the mirror's area, which is (R / r)^2 times
the ball's own L pi r^2 (the Manchester principle); what the ball hides, its own light replaces. A zone at
distance d from the focus sends light up to asin(r / d) off the axis. J. W. T. Walsh, Photometry, 1958,
chapter on projectors. Millimetres.
"""

from math import asin, degrees, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.spectral_meters import Estimate, flat
from tests.accuracy.tracing import Document, trace

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_SEGMENTS = 128
_RINGS = 40

# Focal length, radius of the aperture, radius of the ball: gain; half divergence of the vertex's and of the
# rim's zone, degrees.
MIRRORS = {
    (50.0, 100.0, 1.0): (10000.0, 1.145992, 0.57296734),
    (120.0, 120.0, 3.0): (1600.0, 1.4325437, 1.145992),
}


def _surfaces(focal: float, aperture: float, ball: float) -> list[Document]:
    """Vertex at 0, opening towards +z. All but 4e-7 is reflected at the vertex."""
    radii = np.repeat(np.arange(1, _RINGS + 1) / _RINGS * aperture, _SEGMENTS)
    angles = np.tile(np.arange(_SEGMENTS) * 2 * pi / _SEGMENTS, _RINGS)
    x, y = radii * np.cos(angles), radii * np.sin(angles)
    vertices = [[0.0, 0.0, 0.0], *np.stack([x, y, radii**2 / (4 * focal)], 1).tolist()]
    normals = [[0.0, 0.0, 1.0], *np.stack([-x, -y, np.full_like(x, 2 * focal)], 1).tolist()]
    ring = np.arange(_SEGMENTS)
    following = (ring + 1) % _SEGMENTS
    triangles = [np.stack([np.zeros_like(ring), 1 + ring, 1 + following], 1)]
    for inner in range(1, 1 + (_RINGS - 1) * _SEGMENTS, _SEGMENTS):
        a, b = inner + ring, inner + following
        c, d = a + _SEGMENTS, b + _SEGMENTS
        triangles += [np.stack([a, c, d], 1), np.stack([a, d, b], 1)]
    mesh = {"type": "mesh", "smooth": True, "vertices": vertices, "normals": normals}
    mesh["triangles"] = np.concatenate(triangles).tolist()
    mirror = {"shape": mesh, "kernel": {"type": "conductor", "index": {"n": 0.001, "k": 100.0}}}
    lamp = {"shape": {"type": "sphere", "centre": [0, 0, focal], "radius": ball}, "kernel": BLACK}
    return [mirror, lamp | {"luminaire": {"radiance": 1.0}}]


@pytest.mark.parametrize("mirror", MIRRORS)
def test_gain_on_the_axis(mirror: tuple[float, float, float], tmp_path: Path) -> None:
    """Mean over half a degree around the axis, where every zone still shows the ball; error about 0.1 %.

    The aperture is a polygon, smaller than the circle by a known part, 4.0e-4.
    """
    focal, aperture, ball = mirror
    depth = aperture**2 / (4 * focal)
    holder = sqrt(aperture**2 + (depth / 2) ** 2) + ball
    sensor = {
        "type": "intensity_meter",
        "position": [0, 0, depth / 2],
        "lamp_radius": max(holder, focal - depth / 2 + ball) * 1.001,
        "axis": [0, 0, 1],
    }
    document = {"nocturne": 1, "sensor": sensor, "surfaces": _surfaces(*mirror)}
    image = flat(trace(document, tmp_path, (8, 360), 256))
    polygon = _SEGMENTS / (2 * pi) * sin(2 * pi / _SEGMENTS)
    gain = Estimate.of(image[0] / (pi * ball**2))
    gain.check(MIRRORS[mirror][0] * polygon, sidak_bound(2) * 1.4, mirror)  # 1.4: Student's t of 8 values


@pytest.mark.parametrize("mirror", MIRRORS)
def test_half_divergence(mirror: tuple[float, float, float], tmp_path: Path) -> None:
    """Zones near the vertex and at the rim: light just inside the cone, none just outside (0.5 % of it)."""
    focal, aperture, ball = mirror
    surfaces = _surfaces(*mirror)
    for part, truth in zip((0.05, 1.0), MIRRORS[mirror][1:], strict=True):
        zone = part * aperture
        # At a vertex of the mesh, seen across the meridian, where the ball does not occlude it.
        point = np.array([zone * (1 - 1e-6), 0.0, zone**2 / (4 * focal)])
        half = degrees(asin(ball / (focal + zone**2 / (4 * focal))))
        assert half == pytest.approx(truth, rel=1e-2 if part < 1 else 1e-4)
        for factor, lit in ((0.995, 1.0), (1.005, 0.0)):
            angle = np.radians(half * factor)
            # The mirrored ray goes from the point to the focus turned by the angle.
            towards = np.array([0.0, np.sin(angle), np.cos(angle)])
            sensor = {
                "type": "orthographic",
                "position": (point + 3 * focal * towards).tolist(),
                "look_at": point.tolist(),
                "height": 1e-4,
            }
            document = {"nocturne": 1, "sensor": sensor, "surfaces": surfaces}
            seen = flat(trace(document, tmp_path, 1, 256)).item()
            assert seen == pytest.approx(lit, abs=0.02)
