"""Layers of air that scatters as Rayleigh said, lit by a beam: radiances and colours of the sky.

Truths, with their sources: validation/media.json. Light is unpolarised in the tracer, so they are the scalar
ones. Standard errors come from 64 pixels. False alarms: 0.01 for each test.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.media import rayleigh
from nocturne_scene.spectra.published import visible_wavelengths
from nocturne_scene.validation.documents import (
    EDGE,
    WIDTH,
    diffuse,
    film,
    from_above,
    lit_slab,
    measured_scene,
    quad,
    slab,
    sun,
    surface,
    white_tile,
)
from nocturne_scene.validation.truths import truths

from tests.accuracy.agreement import Values
from tests.accuracy.media import read
from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

TRUTHS: dict[str, Any] = truths("media")
_AIR = {"phase": {"type": "rayleigh"}}
_SAMPLES = 32


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
    """Up at the top and down at the ground, in 16 directions each: cosine to the vertical, azimuth of the
    light in degrees."""
    # The beam comes from azimuth 180.
    light = sun(float(np.degrees(np.arccos(case["mu0"]))), 180.0, irradiance=float(np.pi))
    for side in ("up", "down"):
        for view, truth in case[side].items():
            mu, azimuth = (float(part) for part in view.split("/"))
            sensor = _meter(mu, azimuth, up=side == "up")
            document = _layer(case["thickness"], sensor, case["ground"], light)
            reading = read(document, tmp_path / side / view.replace("/", "-"), _SAMPLES)
            # Down, 1e-3 of the layer is below the sensor.
            reading.check(truth, EDGE + (0.0 if side == "up" else 1e-3), values=32)


@pytest.mark.parametrize(
    "case", TRUTHS["published rayleigh layer"]["cases"], ids=lambda case: str(case["ground"])
)
def test_the_published_layer(case: Document, tmp_path: Path) -> None:
    """Thickness 0.5, mu0 0.2; at mu = 0.02 a ray crosses 25 optical thicknesses."""
    views = {view: truth for view, truth in case.items() if view != "ground"}
    light = sun(float(np.degrees(np.arccos(0.2))), 180.0, irradiance=float(np.pi))
    for view, truth in views.items():
        mu, azimuth = (float(part) for part in view.split("/"))
        document = _layer(0.5, _meter(mu, azimuth, up=True), case["ground"], light)
        reading = read(document, tmp_path / view.replace("/", "-"), _SAMPLES)
        reading.check(truth, EDGE, values=len(views))


@pytest.mark.parametrize("case", TRUTHS["rayleigh layers"]["cases"], ids=_name)
def test_light_above_and_below_a_layer(case: Document, tmp_path: Path) -> None:
    """Flux that goes up and down under a beam, and up under even light; black ground.

    Below, a white tile sees the beam as well, which a film meets once in 1e8 photons.
    """
    light = sun(float(np.degrees(np.arccos(case["mu0"]))), 180.0)
    document = _layer(case["thickness"], film([0, 0, 1e-3], [0.0, 0.0, -1.0], 1e-3), 0.0, light)
    up = read(document, tmp_path / "up", _SAMPLES) * (1.0 / case["mu0"])
    up.check(case["R_flux(black ground)"], EDGE, values=3)
    tile, meter = white_tile(([0.0, 0.0, -0.9999], [0.0, 0.0, 1.0]))
    document = _layer(case["thickness"], meter, 0.0, light)
    document["surfaces"].append(tile)
    down = read(document, tmp_path / "down", _SAMPLES) * (np.pi / case["mu0"])
    down.check(case["T_flux(black ground)"], EDGE, values=3)
    air = {"scattering": case["thickness"], **_AIR}
    even = read(lit_slab(air, 1.0, from_above(1e-3), below=False), tmp_path / "even", _SAMPLES)
    (even * (1.0 / np.pi)).check(case["spherical_albedo"], EDGE, values=3)


@pytest.mark.parametrize("case", TRUTHS["skies"]["cases"], ids=lambda case: f"sun at {case['sun_zenith']}")
def test_colours_of_the_sky(case: Document, tmp_path: Path) -> None:
    """X, Y, Z and x, y in seven directions in cd/m2, and illuminances, with the Sun's own spectrum.

    Azimuth 0 is towards the Sun, which stands 0.05 degrees off that direction so that no meter looks into it.
    A film and a white tile have the illuminance of all. Truth is known to 2e-4.
    """
    depth = rayleigh.optical_depth(visible_wavelengths())
    scattering = {"table": np.column_stack([visible_wavelengths(), depth]).tolist()}
    light = sun(case["sun_zenith"], 0.05, sun=True)
    views = {view: _angles(view) for view in case if "phi" in view}
    values = 5 * len(views) + 2
    for view, (zenith, azimuth) in views.items():
        sensor = _meter(float(np.cos(np.radians(zenith))), azimuth + 180.0, up=False)
        sensor |= {"diameter": 1e-6, "position": [0, 0, -1 + 1e-5]}
        sensor["look_at"] = (np.add(sensor["position"], _towards(zenith, azimuth))).tolist()
        document = _sky(_layer(scattering, sensor, 0.0, light))
        folder = tmp_path / view.replace("/", "-")
        folder.mkdir()
        xyz = Measurement(document, folder, 16, 16).image(_SAMPLES).xyz.astype(np.float64)
        for channel, truth in enumerate(case[view]["XYZ"]):
            Reading.of(_flat(xyz, channel)).check(truth, 2e-4 + EDGE, values)
        for channel, name in enumerate("xy"):
            part = Reading.of(_flat(xyz, channel) / xyz.sum(axis=-1).ravel())
            part.check(case[view][name], 2e-4 + EDGE, values)
    sensor = film([0, 0, -1 + 1e-5], [0, 0, 1], 1e-3)
    document = _sky(_layer(scattering, sensor, 0.0, light))
    reading = read(document, tmp_path, _SAMPLES, edge=16, channel="Y")
    reading.check(case["E_horizontal_total_lx"], 2e-4 + EDGE, values)
    tile, meter = white_tile(([0.0, 0.0, -0.9999], [0.0, 0.0, 1.0]))
    document = _sky(_layer(scattering, meter, 0.0, light))
    document["surfaces"].append(tile)
    reading = read(document, tmp_path / "tile", _SAMPLES, edge=16, channel="Y") * np.pi
    reading.check(case["E_horizontal_total_lx"], 2e-4 + EDGE, values)


def _angles(view: str) -> tuple[float, float]:
    """Zenith angle and azimuth of a key such as VZA60/phi180."""
    zenith, azimuth = view.split("/")
    return float(zenith.removeprefix("VZA") if zenith != "zenith" else 0.0), float(
        azimuth.removeprefix("phi")
    )


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
