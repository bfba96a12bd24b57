"""Slabs of media: how much light they let through and send back.

Truths, with their sources: validation/media.json. Standard errors come from 64 pixels, and are about 1.4 %
where half of the light comes through, more for fainter light. False alarms: 0.01 for each test.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import EDGE, along, from_above, lit_slab, medium, sun
from nocturne_scene.validation.truths import truths

from tests.accuracy.agreement import ROUNDING
from tests.accuracy.media import read
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

TRUTHS: dict[str, Any] = truths("media")
_KEYS = ("R_normal", "T_normal", "R_60deg", "T_60deg", "R_diffuse", "T_diffuse")
_SAMPLES = 64


def name(case: Document) -> str:
    return ", ".join(f"{key} {case[key]:g}" for key in ("albedo", "g", "thickness", "index") if key in case)


def _check(fog: Document, case: Document, folder: Path, keys: tuple[str, ...], **more: Any) -> None:
    thickness = case["thickness"]
    for key in keys:
        diffuse = key.endswith("diffuse")
        sensor = from_above(1e-3) if diffuse else along(60.0 if key.endswith("60deg") else 0.0, 2.0)
        document = lit_slab(fog, thickness, sensor, below=key.startswith("T"), **more)
        reading = read(document, folder / key, _SAMPLES) * (1.0 / np.pi if diffuse else 1.0)
        reading.check(case[key], EDGE, values=len(keys))


@pytest.mark.parametrize("thickness", sorted({case["thickness"] for case in TRUTHS["slabs"]["cases"]}))
def test_light_that_nothing_scatters(thickness: float, tmp_path: Path) -> None:
    """Transmission of a beam along the normal, by Beer and Lambert, through as many free paths of absorption.

    A body of glass absorbs in closed form, however thick it is.
    """
    fog, glass = {"absorption": 1.0}, {"type": "dielectric", "index": 1.0}
    document = lit_slab(fog, thickness, along(0.0, 2.0), below=True, kernel=glass)
    read(document, tmp_path, 4).check(float(np.exp(-thickness)), ROUNDING * max(thickness, 1.0))


@pytest.mark.parametrize("case", TRUTHS["slabs"]["cases"], ids=name)
def test_slabs(case: Document, tmp_path: Path) -> None:
    """Six numbers of each."""
    _check(medium(case["albedo"], case["g"]), case, tmp_path, _KEYS)


@pytest.mark.parametrize("case", TRUTHS["refracting slabs"]["cases"], ids=name)
def test_slabs_with_a_smooth_surface(case: Document, tmp_path: Path) -> None:
    """A medium in glass: light is reflected at both faces, also inside."""
    thick = case["thickness"] > 100.0
    # Of a half space the first 60 mean free paths are enough: exp(-2 x 60 x 0.55).
    case = {**case, "thickness": 60.0} if thick else case
    keys = tuple(key for key in _KEYS if not (thick and key.startswith("T")))
    kernel = {"type": "dielectric", "index": case["index"]}
    _check(medium(case["albedo"], case["g"]), case, tmp_path, keys, kernel=kernel)


@pytest.mark.parametrize("index", [1.33, 1.4, 1.5])
def test_the_surface_of_a_medium_alone(index: float, tmp_path: Path) -> None:
    """What absorbs all that enters reflects, along the normal, what its first face does (Fresnel).

    Standard errors: 0.02 to 0.04 %.
    """
    kernel = {"type": "dielectric", "index": index}
    document = lit_slab({"absorption": 1.0}, 60.0, along(0.0, 2.0), below=False, kernel=kernel)
    truth = ((index - 1.0) / (index + 1.0)) ** 2
    read(document, tmp_path, 128 * _SAMPLES).check(truth, EDGE)


def test_a_half_space_lets_nothing_through(tmp_path: Path) -> None:
    """The refracting slab of optical thickness 2000: no photon comes through."""
    [case] = [case for case in TRUTHS["refracting slabs"]["cases"] if case["thickness"] == 2000.0]
    kernel = {"type": "dielectric", "index": case["index"]}
    _check(medium(case["albedo"]), case, tmp_path, _KEYS[1::2], kernel=kernel)


_PROFILES: dict[str, Document] = {
    # Integrals from -2 to 0 are 2.
    "linear": {"layers": [[-2.0, 0.0], [0.0, 2.0]]},
    "layers": {"layers": [[-2.0, 0.5], [-1.5, 0.5], [-1.4999, 3.0], [-1.2, 3.0], [-1.1999, 0.0], [0.0, 0.0]]},
    "exponential": {"scale_height": 0.5, "at_ground": 2.0 / (0.5 * float(np.expm1(4.0)))},
}


@pytest.mark.parametrize("profile", _PROFILES)
def test_only_optical_thickness_counts(profile: str, tmp_path: Path) -> None:
    """Van de Hulst's slab with densities that vary with depth."""
    density = {**_PROFILES[profile], "above": {"point": [0, 0, 0], "up": [0, 0, 1]}}
    if profile == "layers":
        layers = np.array(density["layers"])
        density["layers"] = [
            [z, value * 2.0 / float(np.trapezoid(layers[:, 1], layers[:, 0]))] for z, value in layers.tolist()
        ]
    [case] = [case for case in TRUTHS["slabs"]["cases"] if name(case) == "albedo 0.9, g 0.75, thickness 2"]
    _check(medium(0.9, 0.75, density=density), case, tmp_path, _KEYS)


def test_van_de_hulsts_slab_by_direction(tmp_path: Path) -> None:
    """Radiance in nine directions above and below, lit by a beam along the normal."""
    cases = TRUTHS["angular"]["cases"]
    for key, known in cases.items():
        mu = float(key.removeprefix("mu="))
        degrees = float(np.degrees(np.arccos(mu)))
        for side, truth in zip((1.0, -1.0), (known["R"], known["T_diffuse"]), strict=True):
            document = lit_slab(medium(0.9, 0.75), 2.0, along(degrees, 2.0), below=True)
            del document["environment"], document["surfaces"][1]
            # A slab seen from below and lit from above is one seen from above and lit from below.
            document["distant"] = [sun(0.0 if side > 0 else 180.0)]
            read(document, tmp_path / f"{mu}{side}", _SAMPLES).check(truth, EDGE, values=2 * len(cases))


@pytest.mark.parametrize("case", TRUTHS["half spaces"]["cases"], ids=name)
def test_half_spaces(case: Document, tmp_path: Path) -> None:
    """Plane albedos and Chandrasekhar's H function, which they are made of, and radiance under a beam."""
    # Diffusion length 1 / sqrt(3 (1 - albedo)): light fades to 1e-9.
    thickness = 10.0 / np.sqrt(3.0 * (1.0 - case["albedo"])) + 5.0
    fog = medium(case["albedo"])
    deep = {**case, "thickness": float(thickness)}
    deep |= {
        key: case[f"A_{name}"] for key, name in zip(_KEYS[::2], ("normal", "60deg", "diffuse"), strict=True)
    }
    _check(fog, deep, tmp_path, _KEYS[::2])
    root = float(np.sqrt(1.0 - case["albedo"]))
    for key, mu in (("H_1", 1.0), ("H_05", 0.5), ("H_02", 0.2)):
        document = lit_slab(fog, deep["thickness"], along(float(np.degrees(np.arccos(mu))), 2.0), below=False)
        absorbed = (read(document, tmp_path / key, _SAMPLES) - 1.0) * (-1.0 / root)
        absorbed.check(case[key], EDGE, values=3)
    for key, degrees in (("fr_0_0", 0.0), ("fr_60_0", 60.0)):
        document = lit_slab(fog, deep["thickness"], along(0.0, 2.0), below=True)
        del document["environment"], document["surfaces"][1]
        document["distant"] = [sun(degrees, irradiance=float(1.0 / np.cos(np.radians(degrees))))]
        read(document, tmp_path / key, _SAMPLES).check(case[key], EDGE, values=2)
