"""One rough boundary of glass: reflected and transmitted parts of light, against quadrature of the model.

GGX with Smith's masking (Walter, Marschner, Li, Torrance: "Microfacet Models for Refraction through Rough
Surfaces", EGSR 2007), height-correlated for reflection (Heitz, JCGT 3(2), 2014, equation 99) and on opposite
sides (Heitz et al., ACM TOG 35(4), 2016, equation 15 of its supplement: a beta function). Light meets the
boundary once.
"""

from math import acos, cos, sin
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_scene.validation.documents import BLACK, measured_scene, quad, surface
from scipy.special import beta

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

Values = npt.NDArray[np.float64]

_INDEX = 1.5
_COSINES = (1.0, 0.6, 0.2)
_ROUGHNESS = (0.1, 0.5)


@pytest.mark.parametrize("alpha", _ROUGHNESS)
def test_parts_of_light(alpha: float, tmp_path: Path) -> None:
    """A sky of radiance 1 above gives the reflected part; a lamp of radiance 1 in the glass below gives the
    transmitted part over n^2, as radiance is n^2 times as large within. False alarms: 0.01 each.
    """
    glass = surface(
        quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]),
        {"type": "dielectric", "index": _INDEX, "roughness": alpha},
    )
    below = quad([-1000, -1000, -1e-3], [2000, 0, 0], [0, 2000, 0])
    for cosine in _COSINES:
        reflected, transmitted = _parts(alpha, cosine)
        sky = measured_scene(_view(cosine), [glass, surface(below)])
        sky["environment"] = {"radiance": 1.0}
        lamp = measured_scene(_view(cosine), [glass, surface(below, BLACK, 1.0)])
        for name, document, truth in (("sky", sky, reflected), ("lamp", lamp, transmitted / _INDEX**2)):
            folder = tmp_path / f"{name}-{cosine}"
            folder.mkdir()
            reading = Measurement(document, folder, 16, 16).by_pixels(256)
            reading.check(truth, 2e-5 + 1e-5 / truth, values=6)


@pytest.mark.parametrize("alpha", _ROUGHNESS)
def test_the_quadrature_has_converged(alpha: float) -> None:
    for cosine in _COSINES:
        assert _parts(alpha, cosine) == pytest.approx(_parts(alpha, cosine, 100), abs=1e-5)


def _view(cosine: float) -> Document:
    angle = acos(cosine)
    return {
        "type": "radiance_meter",
        "position": [0.1 * sin(angle), 0.0, 0.1 * cos(angle)],
        "look_at": [0, 0, 0],
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
    }


def _parts(alpha: float, cosine: float, steps: int = 160) -> tuple[float, float]:
    """Over facet normals m, D(m) (m . n) dm being 2 s ds dphi / (2 pi) for tan = alpha sqrt(1 - s^2) / s."""
    nodes, weights = np.polynomial.legendre.leggauss(steps)
    s = (nodes + 1.0) / 2.0
    weights = weights * s
    phi = (np.arange(steps) + 0.5) * np.pi / steps  # the other half is its mirror image
    tangent = (alpha * np.sqrt(1.0 - s**2) / s)[:, None]
    mz = 1.0 / np.sqrt(1.0 + tangent**2)
    mx = mz * tangent * np.cos(phi)
    sine = np.sqrt(1.0 - cosine**2)
    along = sine * mx + cosine * mz
    seen = np.where(along > 0.0, along, 0.0) / (cosine * mz) * weights[:, None] / steps
    share = _fresnel(along)
    up = 2.0 * along * mz - cosine
    down = _refracted(along, mz, cosine)
    lit = _lambda(alpha, cosine)
    over = np.where(up > 0.0, 1.0 / (1.0 + lit + _lambda(alpha, up)), 0.0)
    under = np.where(down < 0.0, beta(1.0 + lit, 1.0 + _lambda(alpha, down)), 0.0)
    return float((seen * share * over).sum()), float((seen * (1.0 - share) * under).sum())


def _lambda(alpha: float, z: npt.ArrayLike) -> Values:
    squared = np.clip(np.asarray(z) ** 2, 1e-12, 1.0)
    return np.asarray((np.sqrt(1.0 + alpha**2 * (1.0 - squared) / squared) - 1.0) / 2.0)


def _refracted(along: Values, mz: Values, cosine: float) -> Values:
    """The z of Snell's direction."""
    inner = np.sqrt(1.0 - (1.0 - along**2) / _INDEX**2)
    return np.asarray((along / _INDEX - inner) * mz - cosine / _INDEX)


def _fresnel(cosine: Values) -> Values:
    """Unpolarised, from vacuum."""
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / _INDEX**2)
    s = (cosine - _INDEX * inner) / (cosine + _INDEX * inner)
    p = (_INDEX * cosine - inner) / (_INDEX * cosine + inner)
    return np.asarray((s**2 + p**2) / 2.0)
