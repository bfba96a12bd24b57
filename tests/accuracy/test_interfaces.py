"""Rendered reflection of glass and metal surfaces, at an angle and for light from everywhere.

Fresnel's equations of validation/interfaces.json, unpolarised. z values within the Sidak bound of all of this
file's table; false alarms: 0.01 in all.
"""

from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK
from nocturne_scene.validation.truths import truths

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.spectral_meters import (
    NO_ROULETTE,
    Estimate,
    beam,
    flat,
    level,
    measure,
    scene,
    slab,
)
from tests.accuracy.tracing import Document, trace

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_TRUTH = truths("interfaces")
GLASS = {entry["index"]: entry for entry in _TRUTH["glass"]}
METALS = {entry["metal"]: entry for entry in _TRUTH["metals"]}

_BOUND = sidak_bound(80)
_WIDE = 1e3
_SAMPLES = 512


def _film(z: float, upwards: bool) -> Document:
    normal = [0, 0, 1 if upwards else -1]
    return {"type": "irradiance_meter", "position": [0, 0, z], "normal": normal, "height": 1e-3}


def _half_space(index: float) -> list[Document]:
    """Glass below z = 0, with black in it."""
    glass = {"type": "dielectric", "index": index}
    return [slab(-1.0, 0.0, _WIDE, glass), level(-0.5, 0.999 * _WIDE, BLACK)]


@pytest.mark.parametrize("index", GLASS)
def test_glass_reflects_by_angle(index: float, tmp_path: Path) -> None:
    """Standard errors are about 0.15 % to 1.5 % of the reflection, if that is more than 1 %."""
    for angle, truth in GLASS[index]["by_angle"]:
        document = scene(beam(angle), _half_space(index))
        found = measure(document, tmp_path, _SAMPLES)
        # Where hardly a photon is reflected, the error that independent photons would have.
        least = np.sqrt(truth / (64 * _SAMPLES)) if truth < 1e-4 else 0.0
        Estimate(found.mean, max(found.error, least)).check(truth, _BOUND, f"n {index}, {angle} deg")


@pytest.mark.parametrize("index", GLASS)
def test_glass_in_light_from_everywhere(index: float, tmp_path: Path) -> None:
    """Reflected outside; what enters, seen inside; reflected inside. In units of pi times the radiance."""
    outside, inside = GLASS[index]["outside"], GLASS[index]["inside"]
    glass = _half_space(index)
    lamp = level(-0.5, 0.999 * _WIDE, BLACK, luminaire={"radiance": 1.0})
    for what, document, truth in (
        ("outside", scene(_film(1e-2, False), glass), outside),
        ("entering", scene(_film(-1e-2, True), glass), 1.0 - outside),
        ("inside", scene(_film(-1e-2, True), [glass[0], lamp], None), inside),
    ):
        values = flat(trace(document, tmp_path, 8, 2 * _SAMPLES)) / np.pi
        Estimate.of(values).check(truth, _BOUND, f"n {index}, {what}")


@pytest.mark.parametrize("metal", METALS)
def test_metal_reflects(metal: str, tmp_path: Path) -> None:
    """Without roulette only wavelengths and directions of the uniform light are drawn: errors of 1e-5."""
    n, k = METALS[metal]["n"], METALS[metal]["k"]
    mirror = level(0.0, _WIDE, {"type": "conductor", "index": {"n": n, "k": k}})
    for angle, truth in METALS[metal]["by_angle"]:
        document = scene(beam(angle), [mirror], **NO_ROULETTE)
        measure(document, tmp_path, 256).check(truth, _BOUND, f"{metal}, {angle} deg")
    values = flat(trace(scene(_film(1e-2, False), [mirror], **NO_ROULETTE), tmp_path, 8, 1024)) / np.pi
    Estimate.of(values).check(METALS[metal]["uniform"], _BOUND, f"{metal}, uniform")


def _at_30_degrees(entry: Document) -> float:
    return float(dict(entry["by_angle"])[30])


@pytest.mark.parametrize("material", [1.5, *METALS])
def test_photons_from_the_light_are_reflected_alike(material: float | str, tmp_path: Path) -> None:
    """A far lamp at 30 degrees, its mirrored light on a film across it. Standard errors: 0.3 % to 1.5 %."""
    if isinstance(material, str):
        entry = METALS[material]
        kernel: Document = {"type": "conductor", "index": {"n": entry["n"], "k": entry["k"]}}
    else:
        entry, kernel = GLASS[material], {"type": "dielectric", "index": material}
    towards = [0.0, 0.5, float(np.cos(np.pi / 6))]
    sensor = {
        "type": "irradiance_meter",
        "position": [0.0, -0.5, towards[2]],
        "look_at": [0, 0, 0],
        "height": 0.4,
    }
    lamp = {"direction": towards, "angular_diameter_degrees": 0.05, "irradiance": 1.0}
    surfaces = [slab(-0.2, 0.0, 1.0, kernel), level(-0.1, 0.99, BLACK)]
    document = scene(sensor, surfaces, None, direction="forward") | {"distant": [lamp]}
    measure(document, tmp_path, 8192).check(_at_30_degrees(entry), _BOUND, material)
