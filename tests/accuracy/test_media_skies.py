"""Layers of air that scatters as Rayleigh said, lit by a beam: radiances and colours of the sky.

Truths, with their sources: data/media.json. Light is unpolarised in the tracer, so they are the scalar ones.
Standard errors come from 64 pixels. False alarms: 0.01 for each test.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_coordinator.scene import rayleigh
from nocturne_coordinator.scene.published import visible_wavelengths

from tests.accuracy.agreement import Values
from tests.accuracy.media import THINNER, WIDTH, read, slab, sun, thinner
from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.scenes import diffuse, film, measured_scene, quad, surface
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

TRUTHS: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "media.json").read_text())
_AIR = {"phase": {"type": "rayleigh"}}
_SAMPLES = 64

# Direction of view: cosine to the vertical, azimuth of the light in degrees. All three kinds of azimuth.
_VIEWS = ("0.1/0", "0.4/120", "0.7/180", "1.0/0")


def _layer(scattering: Any, sensor: Document, ground: float, light: Document) -> Document:
    """1 m thick, above the ground."""
    soil = surface(quad([-WIDTH, -WIDTH, -1], [2 * WIDTH, 0, 0], [0, 2 * WIDTH, 0]), diffuse(ground))
    document = measured_scene(sensor, [slab(1.0, WIDTH, "air"), soil])
    # The soil closes the slab; at the same height neither would be behind the other.
    document["surfaces"][0]["shape"]["minimum"][2] = -1.1
    air = {"scattering": scattering, **_AIR}
    return document | {"media": {"air": air}, "distant": [light]}


def _meter(mu: float, light_azimuth: float, *, up: bool) -> Document:
    """Looks against light that travels up or down in a direction; the Sun's goes on in azimuth 0."""
    sine, azimuth = float(np.sqrt(1.0 - mu * mu)), np.radians(light_azimuth)
    travel = np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), mu if up else -mu])
    position = np.array([0, 0, 1e-3]) if up else np.array([0, 0, -0.999])
    return {
        "type": "radiance_meter",
        "position": position.tolist(),
        "look_at": (position - travel).tolist(),
        "up": [float(-np.sin(azimuth)), float(np.cos(azimuth)), 0.0],
        "diameter": 1e-4,
        "cone_degrees": 0.01,
    }


def _name(case: Document) -> str:
    return f"thickness {case['thickness']:g}, mu0 {case['mu0']:g}, ground {case['ground']:g}"


@pytest.mark.parametrize("case", TRUTHS["rayleigh layers"]["cases"], ids=_name)
def test_rayleigh_layers(case: Document, tmp_path: Path) -> None:
    """Up at the top and down at the ground."""
    # The beam comes from azimuth 180.
    light = sun(float(np.degrees(np.arccos(case["mu0"]))), 180.0, irradiance=float(np.pi))
    for side in ("up", "down"):
        for view in _VIEWS:
            mu, azimuth = (float(part) for part in view.split("/"))
            sensor = _meter(mu, azimuth, up=side == "up")
            document = _layer(case["thickness"], sensor, case["ground"], light)
            reading = read(document, tmp_path / side / view.replace("/", "-"), _SAMPLES)
            # Down, 1e-3 of the layer is below the sensor.
            reading.check(
                case[side][view], thinner(mu) + (0.0 if side == "up" else 1e-3), values=2 * len(_VIEWS)
            )


def test_the_published_layer_near_the_horizon(tmp_path: Path) -> None:
    """The scalar values of the layer of Natraj, Li and Yung (Astrophysical Journal 691, 2009): thickness 0.5,
    mu0 0.2; at mu = 0.02 a ray crosses 25 optical thicknesses."""
    truths = {"0.02/0": 0.42161244, "0.4/0": 0.1617527, "1.0/0": 0.05835771, "0.02/60": 0.29588128}
    light = sun(float(np.degrees(np.arccos(0.2))), 180.0, irradiance=float(np.pi))
    for view, truth in truths.items():
        mu, azimuth = (float(part) for part in view.split("/"))
        document = _layer(0.5, _meter(mu, azimuth, up=True), 0.0, light)
        read(document, tmp_path / view.replace("/", "-"), _SAMPLES).check(
            truth, thinner(mu), values=len(truths)
        )


def test_light_above_and_below_a_layer(tmp_path: Path) -> None:
    """Flux that goes up and down, black ground.

    Without the beam itself, exp(-thickness / mu0): a film meets so small a sun once in 1e8 photons.
    """
    [case] = [
        case for case in TRUTHS["rayleigh layers"]["cases"] if case["ground"] == 0 and case["mu0"] == 0.2
    ]
    light = sun(float(np.degrees(np.arccos(0.2))), 180.0)
    heights = {"R": (1e-3, [0.0, 0.0, -1.0]), "T": (-0.9999, [0.0, 0.0, 1.0])}
    for key, (height, normal) in heights.items():
        document = _layer(case["thickness"], film([0, 0, height], normal, 1e-3), 0.0, light)
        reading = read(document, tmp_path / key, _SAMPLES) * (1.0 / 0.2)
        beam = float(np.exp(-case["thickness"] / 0.2)) if key == "T" else 0.0
        reading.check(case[f"{key}_flux(black ground)"] - beam, THINNER, values=2)


# Seven views of three skies would take long; the zenith and four more hold all azimuths.
_SKY_VIEWS = {
    "zenith/phi0": (0, 0),
    "VZA60/phi0": (60, 0),
    "VZA60/phi90": (60, 90),
    "VZA30/phi180": (30, 180),
}


@pytest.mark.parametrize("case", TRUTHS["skies"]["cases"], ids=lambda case: f"sun at {case['sun_zenith']}")
def test_colours_of_the_sky(case: Document, tmp_path: Path) -> None:
    """X, Y and Z in cd/m2 in four directions, and illuminance, with the Sun's own spectrum.

    Azimuth 0 is towards the Sun, which stands 0.05 degrees beside it so that no sensor looks into it. A film
    does not meet it either: illuminance is that of the sky. Truth is known to 2e-4.
    """
    depth = rayleigh.optical_depth(visible_wavelengths())
    scattering = {"table": np.column_stack([visible_wavelengths(), depth]).tolist()}
    light = sun(case["sun_zenith"], 0.05, sun=True)
    values = 3 * len(_SKY_VIEWS) + 1
    for view, (zenith, azimuth) in _SKY_VIEWS.items():
        sensor = _meter(float(np.cos(np.radians(zenith))), azimuth + 180.0, up=False)
        sensor |= {"diameter": 1e-6, "position": [0, 0, -1 + 1e-5]}
        sensor["look_at"] = (np.add(sensor["position"], _towards(zenith, azimuth))).tolist()
        document = _sky(_layer(scattering, sensor, 0.0, light))
        folder = tmp_path / view.replace("/", "-")
        folder.mkdir()
        xyz = Measurement(document, folder, 16, 16).image(_SAMPLES).xyz.astype(np.float64)
        for channel, truth in enumerate(case[view]["XYZ"]):
            Reading.of(_flat(xyz, channel)).check(truth, 2e-4 + THINNER, values)
    sensor = film([0, 0, -1 + 1e-5], [0, 0, 1], 1e-3)
    document = _sky(_layer(scattering, sensor, 0.0, light))
    reading = read(document, tmp_path, _SAMPLES, edge=16, channel="Y")
    of_sky = case["E_horizontal_total_lx"] - case["E_horizontal_direct_lx"]
    reading.check(of_sky, 2e-4 + THINNER, values)


def _sky(document: Document) -> Document:
    """Seen by the observer, not in grey."""
    document["sensor"] |= {"wavelengths": "response", "responses": {}}
    return document


def _towards(zenith: float, azimuth: float) -> Values:
    zenith, azimuth = np.radians(zenith), np.radians(azimuth)
    return np.array(
        [np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)], dtype=np.float64
    )


def _flat(xyz: Values, channel: int) -> Values:
    return xyz[..., channel].ravel()
