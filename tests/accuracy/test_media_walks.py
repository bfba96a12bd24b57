"""Where photons go in a medium without bounds, read off a medium that glows in known places.

A photon counts the glow wherever it collides, so the image is the sum of the glow over its collisions. At
1e9 K a black body's radiance is proportional to its temperature (Rayleigh and Jeans; the next term is
14,388 K less), which a grid holds, linear between voxels. A response that grows with the fourth power of the
wavelength takes the spectrum out. Published values: validation/media.json. False alarms: 0.01 for each test.
"""

import json
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from math import atanh, exp, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_client.local.programs import find_program, need_program
from nocturne_scene.validation.truths import truths
from scipy.integrate import quad as integral
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from tests.accuracy.agreement import Values
from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document, part_of

pytestmark = [
    pytest.mark.system,
    pytest.mark.every_sixth,
    pytest.mark.skipif(find_program("nocturne-grid") is None, reason="nocturne-grid is not built"),
]

TRUTHS: dict[str, Any] = truths("media")

_HOT = 1e9
"""Kelvin, where the glow is 1."""

# c1 / c2 / nm^4, W m-2 sr-1 nm-1 per kelvin at 500 nm: CODATA 2018.
_RADIANCE = _HOT * 1.191042972e20 / 1.438776877e7 / 500.0**4

_CELLS = 48

_WHITE = 1.0 - 1e-3
_ANALOG: Document = {"estimator": "mixture", "h": 1e6}
"""No photon dies."""


@dataclass(frozen=True)
class Glow:
    """A glow around the origin, on a lattice; linear in between."""

    half_edge: float
    """Of the cube of voxels' centres, in free paths."""
    values: Values
    """Shape (_CELLS, _CELLS, _CELLS): along x, y, z."""

    @classmethod
    def of(cls, half_edge: float, function: Callable[[Values, Values], Values]) -> "Glow":
        """Of a function of z and of the distance from the origin."""
        x, y, z = places(half_edge)
        return cls(half_edge, function(z, np.sqrt(x * x + y * y + z * z)))

    def write(self, folder: Path) -> None:
        """As glow.vdb."""
        (folder / "glow.f32").write_bytes((_HOT * self.values).astype("<f4").tobytes())
        description = {
            "dims": self.values.shape,
            "voxel_size": spacing(self.half_edge),
            "origin": [-self.half_edge] * 3,
            "grids": [{"name": "temperature", "file": "glow.f32"}],
        }
        (folder / "glow.json").write_text(json.dumps(description))
        program = need_program("nocturne-grid")
        subprocess.run(
            [program, "create", folder / "glow.json", "-o", folder / "glow.vdb"],
            check=True,
            capture_output=True,
        )


def spacing(half_edge: float) -> float:
    return 2.0 * half_edge / (_CELLS - 1)


def places(half_edge: float) -> list[Values]:
    """x, y and z of the voxels' centres."""
    along = np.linspace(-half_edge, half_edge, _CELLS)
    return list(np.meshgrid(along, along, along, indexing="ij"))


def _counted(glow: Glow, albedo: float, g: float, samples: int, folder: Path, **tracing: Any) -> Values:
    """Sum of the glow over the collisions of a photon that starts from the origin along z, by pixels.

    Each counts with (1 - albedo) times the photon's remaining weight.
    """
    folder.mkdir(parents=True, exist_ok=True)
    glow.write(folder)
    nm = np.arange(360, 831)
    sensor = {
        "type": "radiance_meter",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "diameter": 1e-6,
        "cone_degrees": 1e-3,
        "wavelengths": "uniform",
        "responses": {"grey": {"table": np.column_stack([nm, (nm / 500.0) ** 4]).tolist()}},
    }
    temperature = {"asset": "glow.vdb", "grid": "temperature"}
    fog = {"scattering": albedo, "absorption": 1.0 - albedo, "temperature": temperature}
    fog |= {"phase": {"type": "henyey_greenstein", "g": g}} if g else {}
    # A scene needs a surface; one that no photon comes to.
    far = {"type": "sphere", "centre": [0, 0, 1e6], "radius": 1e-3}
    document: Document = {
        "nocturne": 1,
        "sensor": sensor,
        "surfaces": [{"shape": far, "kernel": {"type": "lambertian", "reflectance": 0}}],
        "media": {"fog": fog},
        "unbounded_media": ["fog"],
        "tracing": tracing,
    }
    image = Measurement(document, folder, 8, 8).image(part_of(samples))
    return image.further["grey"].astype(np.float64) / ((830.0 - 360.0) * _RADIANCE)


def fluence(albedo: float, r: float) -> float:
    """Of an isotropic point source of power 1 in an infinite medium with isotropic scattering, per square of
    a free path (Case, de Hoffmann and Placzek 1953; Case and Zweifel, Linear Transport Theory, 1967).

    The pole and the cut of arctan(k) / k / (1 - albedo arctan(k) / k).
    """
    kappa = brentq(lambda k: albedo * atanh(k) / k - 1.0, 1e-9, 1.0 - 1e-15, xtol=1e-15)
    pole = 2.0 * kappa**2 * exp(-kappa * r) / (albedo**2 / (1.0 - kappa**2) - albedo)

    # nu = 1 / t.
    def cut(t: float) -> float:
        real = 1.0 - albedo * t * atanh(t)
        return exp(-r / t) / (t * t * (real * real + (0.5 * pi * albedo * t) ** 2))

    return float(pole + integral(cut, 0.0, 1.0, epsrel=1e-10, limit=400)[0]) / (4.0 * pi * r)


_SAMPLES = {0.5: 512, 0.9: 128, 0.99: 24}
_SHELL = 0.15
"""Standard deviation of a shell over its radius."""


@pytest.mark.parametrize(
    "case", TRUTHS["point sources"]["cases"], ids=lambda case: f"albedo {case['albedo']}"
)
def test_fluence_around_a_point(case: Document, tmp_path: Path) -> None:
    """Collisions of photons from a point, in shells around it: as many as a point source's fluence there.

    Seven distances. Standard errors: 0.3 to 4 % for albedo 0.5, 0.7 to 1.7 % for 0.9, 1.4 to 4 % for 0.99.
    """
    albedo, published = case["albedo"], case["fluence"]
    for key, value in published.items():
        r = float(key)
        assert fluence(albedo, r) == pytest.approx(value, rel=1e-6)
        shell = Glow.of(1.8 * r, partial(_shell, r))
        truth = (1.0 - albedo) * _over_voxels(shell, albedo)
        reading = Reading.of(_counted(shell, albedo, 0.0, _SAMPLES[albedo], tmp_path / key))
        # Next to the second moments of a pyramid come the fourth.
        reading.check(truth, 1e-4, values=len(published))


@cache
def _smooth_fluence(albedo: float) -> CubicSpline:
    """Logarithm of fluence times r^2, over the logarithm of r."""
    distances = np.geomspace(1e-3, 50.0, 150)
    return CubicSpline(np.log(distances), np.log([fluence(albedo, r) * r * r for r in distances]))


def _shell(radius: float, _: Values, distance: Values) -> Values:
    around: Values = np.exp(-0.5 * ((distance / radius - 1.0) / _SHELL) ** 2)
    return around


def _over_voxels(glow: Glow, albedo: float) -> float:
    """Integral of glow times fluence: of the fluence a voxel sees the mean over a pyramid that reaches to its
    neighbours, whose second moments are h^2 / 6."""
    h = spacing(glow.half_edge)
    x, y, z = places(glow.half_edge)
    distance = np.sqrt(x * x + y * y + z * z)
    smooth, at = _smooth_fluence(albedo), np.log(distance)
    value = np.exp(smooth(at)) / distance**2
    first, second = smooth(at, 1) - 2.0, smooth(at, 2)
    # In terms of s, the logarithm over that of r: f (s'' + s'^2 + s') / r^2.
    laplacian = value * (second + first**2 + first) / distance**2
    return float((glow.values * (value + h * h / 12.0 * laplacian)).sum() * h**3)


@pytest.mark.parametrize("case", TRUTHS["moments"]["cases"], ids=lambda case: f"g {case['g']}, n {case['n']}")
def test_moments_of_the_position(case: Document, tmp_path: Path) -> None:
    """Mean of z and of the square of the distance after n free paths from the origin, the first along z.

    It is what the n-th collision adds: allowed one collision less, the same photons count all the others.
    Standard errors: 0.1 to 2 % of z, 0.1 to 0.7 % of the square.
    """
    n, g = case["n"], case["g"]
    edge = 3.0 * n if g == 0.0 else 1.7 * n
    h = spacing(edge)
    glows = {
        "z": (Glow.of(edge, lambda z, _: 0.5 + 0.5 * z / edge), 0.5 + 0.5 * case["z"] / edge),
        # Between two voxels a parabola is below the straight line, by h^2 / 6 in the mean for each axis.
        "r2": (Glow.of(edge, lambda _, r: (r * r + 0.5 * h * h) / edge**2), (case["r2"] + h * h) / edge**2),
    }
    for key, (glow, truth) in glows.items():
        more, fewer = (
            _counted(
                glow,
                _WHITE,
                g,
                128 if n == 100 else 256,
                tmp_path / f"{key}{depth}",
                **_ANALOG,
                maximum_depth=depth,
            )
            for depth in (n - 1, n - 2)
        )
        part = (1.0 - _WHITE) * _WHITE ** (n - 1)
        last = Reading.of((more - fewer) / part)
        last.check(truth, 3e-5, values=2)
