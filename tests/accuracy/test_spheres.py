"""Balls of glass and drops of water: where parallel light goes.

A ray that meets a ball at height h (radius 1) is turned by 2 (i - r) + k (180 - 2 r) degrees after k inner
reflections, with sin i = h = n sin r: Descartes; van de Hulst, Light Scattering by Small Particles, chapter
13.
"""

from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest

from tests.accuracy.ruler import Ruler, Vector
from tests.accuracy.tracing import IN_FULL, Document, trace

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

# Height of the ray: distance from the centre where it crosses the axis, radii; deviation, degrees.
CROSSINGS = {
    1.5: {
        0.1: (1.4958271, 3.8332335),
        0.3: (1.4619784, 11.841288),
        0.5: (1.3915729, 21.057559),
        0.7: (1.277787, 33.217729),
        0.9: (1.1044456, 54.576339),
    },
    1.5168: {
        0.1: (1.4635007, 3.9180341),
        0.3: (1.4311354, 12.100305),
        0.5: (1.3638903, 21.505983),
        0.7: (1.2554972, 33.886396),
        0.9: (1.0917344, 55.525311),
    },
    2.0: {
        0.1: (0.9987508, 5.746373),
        0.3: (0.98882494, 17.661353),
        0.5: (0.9695357, 31.044976),
        0.7: (0.94373392, 47.879378),
        0.9: (0.93249946, 74.828767),
    },
}

# nm: index of water at 20 C (Daimon and Masumura, Applied Optics 46, 2007); radius of the bow that is made
# by one inner reflection, at most, and by two, at least, degrees from the antisolar point.
RAINBOWS = {
    404.656: (1.34312306, 40.6285254, 53.509179),
    486.1327: (1.33749186, 41.4293708, 52.0612145),
    589.3: (1.33334906, 42.0273743, 50.9822121),
    656.2725: (1.3315126, 42.2948985, 50.5001067),
}


def _ball(index: float, height: float, film: float) -> Document:
    """A ball of radius 1 around the origin in parallel light along z; the film is around x = 0, y =
    height.
    """
    return {
        "nocturne": 1,
        "sensor": {
            "type": "orthographic",
            "position": [0.0, height, -2.0],
            "look_at": [0.0, height, 0.0],
            "height": film,
        },
        "surfaces": [
            {
                "shape": {"type": "sphere", "centre": [0, 0, 0], "radius": 1.0},
                "kernel": {"type": "dielectric", "index": index},
            }
        ],
    }


def _turned(deviation: float) -> Vector:
    """Along z, turned towards -y."""
    return np.array([0.0, -sin(radians(deviation)), cos(radians(deviation))])


@pytest.mark.parametrize("index", CROSSINGS)
def test_a_ball_lens_focuses_exactly(index: float, tmp_path: Path) -> None:
    """Crossings within 1e-5 radii and deviations within 2e-4 degrees, by single precision along the path."""
    for height, (crossing, deviation) in CROSSINGS[index].items():
        ball = _ball(index, height, 1e-6)
        axis = _turned(deviation)
        if crossing > 1.01:
            near = Ruler.at(np.array([0.0, 0.0, crossing]), axis, 0.005)
            shift = near.read(ball, tmp_path, (1, 1), 64).place().item() / sin(radians(deviation))
            assert abs(shift) < 1e-5
        # Where the light leaves the ball, for a crossing that is inside of it.
        far = Ruler.at(np.array([0.0, 0.0, crossing]) + 1000.0 * axis, axis, 2.0)
        turn = far.read(ball, tmp_path, (1, 1), 64).place().item() / 1000.0
        assert abs(np.degrees(turn)) < 2e-4


@pytest.mark.parametrize("nm", RAINBOWS)
@pytest.mark.parametrize("reflections", [1, 2])
def test_rainbows_stand_where_descartes_says(nm: float, reflections: int, tmp_path: Path) -> None:
    """The least deviation over heights of incidence, by a curve through 32 of them, within 5e-4
    degrees.
    """
    index, *radii = RAINBOWS[nm]
    radius = radii[reflections - 1]
    expected = 180.0 - radius if reflections == 1 else 180.0 + radius
    height = np.sqrt(1.0 - (index**2 - 1.0) / (reflections * (reflections + 2.0)))
    axis = _turned(expected)
    ruler = Ruler.at(1e6 * axis, axis, 1e6 * radians(0.3))
    reading = ruler.read(_ball(index, float(height), 0.02), tmp_path, (1, 32), 2048)
    deviations = expected - np.degrees(reading.place()[:, 0] / 1e6)
    steps = (np.arange(32) - 15.5) / 16.0
    curve = np.polynomial.Polynomial.fit(steps, deviations, 4)
    least = curve(np.linspace(-1.0, 1.0, 2001)).min()
    assert least < min(curve(-1.0), curve(1.0))
    assert least == pytest.approx(expected, abs=5e-4)


@pytest.mark.parametrize("nm", RAINBOWS if IN_FULL else [*RAINBOWS][:1])
def test_rainbows_by_photons_from_the_sun(nm: float, tmp_path: Path) -> None:
    """Photons leave a drop, in bins of 0.011 degrees around both bows, as Descartes' rays do.

    The lamp has a diameter of 0.01 degrees, so the edges are as soft. Every photon counts the same, so the
    Kolmogorov-Smirnov bound holds: 1.95 / sqrt(n) is passed with probability 0.001, less with bins.
    """
    index, *radii = RAINBOWS[nm]
    lamp = {"direction": [0, 0, -1], "angular_diameter_degrees": 0.01, "irradiance": 1.0}
    document = _ball(index, 0.0, 1.0) | {
        "sensor": {
            "type": "intensity_meter",
            "position": [0, 0, 0],
            "lamp_radius": 1.01,
            "axis": [0, 0, -1],
            "wavelengths": "uniform",
            "responses": {"all": 1.0},
        },
        "distant": [lamp],
        "tracing": {"direction": "forward", "photons_together": 1},
    }
    image = trace(document, tmp_path, (1, _BINS), 108).further["all"][:, 0].astype(np.float64)
    edges = np.linspace(0.0, 180.0, _BINS + 1)
    photons = image * (np.cos(np.radians(edges[:-1])) - np.cos(np.radians(edges[1:])))
    for reflections, radius in enumerate(radii, start=1):
        middle = round(radius * _BINS / 180.0)
        bins = slice(middle - 15, middle + 15)
        counts = photons[bins] / photons[photons > 0].min()
        # The counts on the dark side of the edge are those of other orders.
        counts -= (counts[-10:] if reflections == 1 else counts[:10]).mean()
        wanted, _ = np.histogram(_bow(index, reflections), edges[bins.start : bins.stop + 1])
        apart = np.abs(np.cumsum(counts) / counts.sum() - np.cumsum(wanted) / wanted.sum()).max()
        assert counts.sum() > 300
        assert apart < 1.95 / np.sqrt(counts.sum())


_BINS = 16000
"""Rows of the film."""


def _bow(index: float, reflections: int) -> Vector:
    """Angles from the antisolar point of light that is spread evenly over the drop around the bow's rays.

    Losses at the surfaces hardly change over so little.
    """
    sine = np.sqrt(1.0 - (index**2 - 1.0) / (reflections * (reflections + 2.0)))
    random = np.random.default_rng(1)
    heights = np.sqrt(random.uniform((sine - 0.03) ** 2, (sine + 0.03) ** 2, 400_000))
    turns = 2 * (np.arcsin(heights) - (reflections + 1) * np.arcsin(heights / index)) + reflections * np.pi
    disc = 0.005 * np.sqrt(random.random(heights.size)) * np.cos(2 * np.pi * random.random(heights.size))
    return np.asarray(np.abs(180.0 - np.degrees(turns)) + disc)
