"""Bodies and surfaces that touch, upright and turned: no photon steps over any of them.

Sums over all inner reflections, unpolarised at every bounce (Stokes 1862); light between a diffuse surface
and the glass on it as Saunderson, J. Opt. Soc. Am. 32, 1942. z values within the Sidak bound of all of this
file's; false alarms 0.01 in all.
"""

from math import cos, exp, radians, sin, sqrt
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.validation.documents import BLACK, diffuse
from scipy.integrate import quad as integral

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.spectral_meters import beam, level, measure, scene, slab
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_BOUND = sidak_bound(60)
_TURNED: Document = {"axis": [1.0, 0.3, 0.2], "degrees": 33.0}
_WIDE = 20.0


def _turned(turned: bool, surfaces: list[Document]) -> list[Document]:
    return [surface | ({"rotate": _TURNED} if turned else {}) for surface in surfaces]


def _along(turned: bool, angle: float = 0.0) -> Document:
    """A thin film that looks at the origin at an angle to the plates' normal."""
    sensor = beam(angle)
    if not turned:
        return sensor
    x, y, z = _TURNED["axis"]
    norm = (x * x + y * y + z * z) ** 0.5
    axis = (x / norm, y / norm, z / norm)

    def turn(v: list[float]) -> list[float]:
        c, s = cos(radians(_TURNED["degrees"])), sin(radians(_TURNED["degrees"]))
        along = sum(a * b for a, b in zip(axis, v, strict=True))
        across = [
            axis[1] * v[2] - axis[2] * v[1],
            axis[2] * v[0] - axis[0] * v[2],
            axis[0] * v[1] - axis[1] * v[0],
        ]
        return [c * v[i] + s * across[i] + (1 - c) * along * axis[i] for i in range(3)]

    return sensor | {"position": turn(sensor["position"]), "up": turn(sensor["up"])}


def _seen(surfaces: list[Document], turned: bool, below: bool, angle: float = 0.0, **more: Any) -> Document:
    """With light from below or from above only."""
    dark = level(50.0 if below else -50.0, 1e5, BLACK)
    return scene(_along(turned, angle), _turned(turned, [*surfaces, dark])) | more


def _reflectance(n: float, cosine: float) -> float:
    """Of light that comes from index 1 to n, unpolarised (Fresnel)."""
    t = sqrt(1.0 - (1.0 - cosine * cosine) / (n * n))
    s, p = (cosine - n * t) / (cosine + n * t), (n * cosine - t) / (n * cosine + t)
    return 0.5 * (s * s + p * p)


def _stack(*boundaries: float) -> float:
    """Transmittance of boundaries by their ratios of indices, at normal incidence: reciprocals add up."""
    reflected = [((n - 1.0) / (n + 1.0)) ** 2 for n in boundaries]
    return 1.0 / (1.0 + sum(r / (1.0 - r) for r in reflected))


def _glass(index: float = 1.5, **more: Any) -> Document:
    return {"type": "dielectric", "index": index, **more}


@pytest.mark.parametrize("turned", [False, True], ids=["upright", "turned"])
@pytest.mark.parametrize("first", ["glass", "table"])
def test_glass_on_a_table_that_shines(first: str, turned: bool, tmp_path: Path) -> None:
    """Radiance in glass is n^2 times its value outside."""
    plate = slab(0.0, 0.5, _WIDE, _glass())
    table = level(0.0, 2 * _WIDE, BLACK) | {"luminaire": {"radiance": 1.0}}
    surfaces = [plate, table] if first == "glass" else [table, plate]
    document = _seen(surfaces, turned, below=True)
    measure(document, tmp_path, 1024).check(0.96 / 1.5**2, _BOUND, (first, turned))


@pytest.mark.parametrize("turned", [False, True], ids=["upright", "turned"])
@pytest.mark.parametrize("reflectance", [0.2, 0.9])
def test_glass_on_a_white_table(reflectance: float, turned: bool, tmp_path: Path) -> None:
    """Even light from above; light goes on to and fro under the glass, far enough inside its rim."""
    outside = 2.0 * integral(lambda mu: mu * _reflectance(1.5, mu), 0.0, 1.0)[0]
    inside = 1.0 - (1.0 - outside) / 1.5**2
    back = reflectance * (1.0 - outside) / (1.0 - reflectance * inside)
    truth = 0.04 + 0.96 / 1.5**2 * back
    plate, table = slab(0.0, 0.02, _WIDE, _glass()), level(0.0, 2 * _WIDE, diffuse(reflectance))
    document = _seen([plate, table], turned, below=False)
    measure(document, tmp_path, 1024).check(truth, _BOUND, (reflectance, turned))


@pytest.mark.parametrize("turned", [False, True], ids=["upright", "turned"])
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_three_liquids(order: tuple[int, int, int], turned: bool, tmp_path: Path) -> None:
    """Two boundaries where bodies touch; their priorities, all the same, do not matter."""
    bodies = [slab(-1.0 - i, -float(i), _WIDE, _glass(n)) for i, n in enumerate((1.8, 1.33, 1.5))]
    truth = _stack(1.8, 1.8 / 1.33, 1.5 / 1.33, 1.5)
    document = _seen([bodies[i] for i in order], turned, below=True)
    estimate = measure(document, tmp_path, 1024)
    estimate.check(truth, _BOUND, (order, turned))
    assert estimate.error < 2e-3


@pytest.mark.parametrize("turned", [False, True], ids=["upright", "turned"])
@pytest.mark.parametrize("bodies", ["twice", "side by side"])
def test_one_plate_in_two_bodies(bodies: str, turned: bool, tmp_path: Path) -> None:
    """The same plate twice in one place; and a plate cut in two where nobody looks."""
    plates = [slab(-1.0, 0.0, _WIDE, _glass(absorption=0.1))] * 2
    if bodies == "side by side":
        plates = [
            slab(-0.4, 0.0, _WIDE, _glass(absorption=0.1)),
            slab(-1.0, -0.4, _WIDE, _glass(absorption=0.1)),
        ]
    angle = 60.0
    mu = (1.0 - (sin(radians(angle)) / 1.5) ** 2) ** 0.5
    r, a = _reflectance(1.5, cos(radians(angle))), exp(-0.1 / mu)
    truth = (1.0 - r) ** 2 * a / (1.0 - (r * a) ** 2)
    document = _seen(plates, turned, below=True, angle=angle)
    measure(document, tmp_path, 1024).check(truth, _BOUND, (bodies, turned))


@pytest.mark.parametrize("turned", [False, True], ids=["upright", "turned"])
@pytest.mark.parametrize("angle", [0.0, 60.0])
def test_two_banks_of_fog(angle: float, turned: bool, tmp_path: Path) -> None:
    """Transmission through absorbing fogs of 0.3 m at 1/m and of 0.5 m at 2/m."""
    document = _seen(
        [
            {"shape": slab(-0.3, 0.0, _WIDE, None)["shape"], "interior": {"media": ["thin"]}},
            {"shape": slab(-0.8, -0.3, _WIDE, None)["shape"], "interior": {"media": ["thick"]}},
        ],
        turned,
        below=True,
        angle=angle,
        media={
            "thin": {"scattering": 0.0, "absorption": 1.0},
            "thick": {"scattering": 0.0, "absorption": 2.0},
        },
    )
    truth = exp(-1.3 / cos(radians(angle)))
    measure(document, tmp_path, 4096).check(truth, _BOUND, (angle, turned))
