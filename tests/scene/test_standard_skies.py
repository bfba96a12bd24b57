"""CIE standard skies: known values of their formulas, and the light that compiled ones give."""

import math
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.spectra.published import visible_wavelengths
from nocturne_scene.textures import standard_skies

from .conftest import Compile, expect_problem

Values = np.ndarray[Any, np.dtype[np.float64]]


def at(kind: int, zenith_degrees: float, from_sun_degrees: float = 90.0, sun_degrees: float = 45.0) -> float:
    z, from_sun, sun = np.cos(np.radians([zenith_degrees, from_sun_degrees, sun_degrees]))
    found = standard_skies.relative_luminance(kind, np.array([z]), np.array([from_sun]), float(sun))
    return float(found[0])


@pytest.mark.parametrize("kind", range(1, 17))
def test_the_zenith_is_one(kind: int) -> None:
    assert at(kind, 0.0, from_sun_degrees=45.0, sun_degrees=45.0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("kind", "at_the_horizon"),
    # 1 over phi(0) where there is no indicatrix; a third for Moon and Spencer's sky.
    [(1, 1 / (1 + 4 * math.exp(-0.7))), (3, 1 / (1 + 1.1 * math.exp(-0.8))), (5, 1.0), (16, 1 / 3)],
)
def test_the_horizon_of_skies_without_a_sun(kind: int, at_the_horizon: float) -> None:
    assert at(kind, 89.99) == pytest.approx(at_the_horizon, rel=1e-3)
    assert not standard_skies.needs_sun(kind)


def test_a_clear_sky_is_brightest_at_the_sun_and_darkest_far_from_it() -> None:
    """Type 12, the Sun at 45 degrees: at the Sun phi(45) f(0) / (phi(0) f(45)), by hand 4.03."""
    phi = [1 - math.exp(-0.32 / math.cos(angle)) for angle in (math.pi / 4, 0.0)]
    f = [
        1 + 10 * (math.exp(-3 * chi) - math.exp(-1.5 * math.pi)) + 0.45 * math.cos(chi) ** 2
        for chi in (0.0, math.pi / 4)
    ]
    assert at(12, 45.0, 0.0) == pytest.approx(phi[0] * f[0] / (phi[1] * f[1]))
    assert at(12, 45.0, 0.0) > 4.0 > 1.0 > at(12, 45.0, 90.0)


@pytest.mark.parametrize(
    ("kind", "ratio"),
    # Illuminance over the zenith's luminance: pi for a uniform sky, 7 pi / 9 for Moon and Spencer's.
    [(5, math.pi), (16, 7 * math.pi / 9)],
)
def test_the_illuminance_of_the_ground(kind: int, ratio: float) -> None:
    texels = standard_skies.texels(kind, 1.0, 256, 512)
    assert standard_skies.illuminance(texels) == pytest.approx(ratio, rel=1e-4)
    assert not texels[128:].any()


def luminances(scene: scene_pb2.CompiledScene, blobs: BlobStore) -> Values:
    """Of all texels, as the tracer finds them."""
    sky = scene.environment.map
    texels = np.frombuffer(blobs.path(sky.blob.hex()).read_bytes(), "<f4").reshape(sky.rows, sky.columns, 4)
    wavelengths = visible_wavelengths()
    light = spectra.evaluate(scene.spectra[sky.spectrum], wavelengths) * spectra.response()[:, 1]
    shapes = rgb_spectra.spectra_of(texels[::16, ::64, 1:].astype(np.float64), wavelengths)
    return np.asarray(texels[::16, ::64, 0] * (shapes @ light), dtype=np.float64)


def test_a_compiled_sky_has_its_luminances(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["environment"] = {"cie": 12, "sun": [1, 1, 0], "zenith_luminance": 3000}
    scene = compiled(document)
    frame = scene.environment.map
    assert [frame.z.x, frame.z.y, frame.z.z] == [0, 1, 0]
    assert [frame.x.x, frame.x.y, frame.x.z] == pytest.approx([1, 0, 0])
    expected = 3000 * standard_skies.texels(12, math.sqrt(0.5), frame.rows, frame.columns)[::16, ::64]
    assert luminances(scene, blobs) == pytest.approx(expected, rel=2e-3)
    document["environment"] = {"cie": 16, "illuminance": 10_000}
    overcast = luminances(compiled(document), blobs)
    assert overcast[0, 0] == pytest.approx(10_000 * 9 / (7 * math.pi), rel=5e-3)


@pytest.mark.parametrize("y", [0.25, 1.75, 2.25, 2.75])
def test_texels_are_fine_enough_for_a_roof_light(
    document: dict[str, Any], compiled: Compile, y: float
) -> None:
    """Points of the floor in case 5.9 of CIE 171:2006 under sky 8, the Sun 30 degrees from the zenith: with
    rows of 7.2 degrees they read up to 0.28 % more."""
    sun = np.array([0.0, 0.5, math.sqrt(0.75)])
    document["environment"] = {"cie": 8, "sun": sun.tolist(), "up": [0, 0, 1], "zenith_luminance": 1}
    frame = compiled(document).environment.map
    texels = standard_skies.texels(8, sun[2], frame.rows, frame.columns)
    # An opening of 1 m in the middle of a ceiling 3 m above.
    across = np.linspace(1.5, 2.5, 1500, endpoint=False) + 0.5 / 1500
    to = np.stack([*np.meshgrid(across - 2.0, across - y), np.full((1500, 1500), 3.0)], axis=-1)
    square = np.sum(to**2, axis=-1)
    cosine = 3.0 / np.sqrt(square)
    right = standard_skies.relative_luminance(8, cosine, to @ sun / np.sqrt(square), sun[2])
    turned = (np.arctan2(to[..., 1], to[..., 0]) - np.pi / 2) / (2 * np.pi) % 1.0
    found = texels[(0.5 * (1 - cosine) * frame.rows).astype(int), (turned * frame.columns).astype(int)]
    weight = cosine**2 / square
    assert np.sum(found * weight) == pytest.approx(np.sum(right * weight), rel=3e-4)


@pytest.mark.parametrize(
    ("sky", "place", "words"),
    [
        ({"cie": 17, "zenith_luminance": 1}, "$.environment.cie", "16"),
        ({"cie": 12, "zenith_luminance": 1}, "$.environment.sun", "brighter near the Sun"),
        ({"cie": 12, "sun": [1, -1, 0], "zenith_luminance": 1}, "$.environment.sun", "below the horizon"),
        ({"cie": 5}, "$.environment", "expected one of zenith_luminance and illuminance"),
    ],
)
def test_what_is_no_sky_is_refused(
    document: dict[str, Any], blobs: BlobStore, sky: dict[str, Any], place: str, words: str
) -> None:
    document["environment"] = sky
    expect_problem(document, blobs, place, words)
