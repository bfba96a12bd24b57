"""The Sun by place and time, skies by measured irradiances, and both in compiled scenes."""

import math
from datetime import datetime
from typing import Any

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.daylight import perez
from nocturne_scene.daylight.solar_position import Air, Place, julian_day, sun_at
from nocturne_scene.spectra.published import visible_wavelengths
from nocturne_scene.textures import standard_skies

from .conftest import Compile, expect_problem
from .test_standard_skies import luminances

STUTTGART = {"latitude": 48.8, "longitude": 9.2, "altitude": 250.0}
MORNING = "2026-03-21T09:00+01:00"


def at(time: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([julian_day(datetime.fromisoformat(time))])


def test_the_published_example() -> None:
    """NREL/TP-560-34302, table A5.1."""
    days = at("2003-10-17T12:30:30-07:00")
    assert days[0] == pytest.approx(2452930.312847, abs=1e-6)
    sun = sun_at(days, Place(39.742476, -105.1786, 1830.14), Air(820.0, 11.0), delta_t=67.0)
    assert sun.zenith[0] == pytest.approx(50.11162, abs=1e-5)
    assert sun.azimuth[0] == pytest.approx(194.34024, abs=1e-5)
    assert sun.distance[0] == pytest.approx(0.9965422974, abs=1e-9)


def test_the_sun_goes_from_east_to_west() -> None:
    """On the day of the equinox, 2026-03-20, it rises in the east and sets in the west, and at noon it is in
    the south, 90 degrees minus the latitude high."""
    sun = sun_at(np.concatenate([at(f"2026-03-20T{hour}:00Z") for hour in ("06", "12", "18")]), Place(50, 0))
    east, north, up = sun.towards().T
    assert east[0] > 0.99
    assert east[2] < -0.99
    assert np.abs(up[[0, 2]]).max() < 0.05
    assert north[1] == pytest.approx(-math.cos(math.radians(40)), abs=0.01)
    assert up[1] == pytest.approx(math.sin(math.radians(40)), abs=0.01)


@pytest.mark.parametrize(
    ("direct", "diffuse", "lux", "parameters"),
    # gendaylit of Radiance 6.0a, `-ang 40 30 -W DIRECT DIFFUSE -O 2`: its solar radiance times the disc's
    # solid angle, and the numbers of its sky. It has 2 cm of water, and 1415 W/m2 above the air.
    [
        (800, 100, 81_840, (-0.975466, -0.211459, 14.590319, -3.910569, 0.587551)),
        (300, 250, 28_630, (-1.031993, -0.748280, 12.759539, -3.158334, 0.146363)),
        (120, 180, 11_589, (-1.137712, -0.574571, 11.847791, -3.344745, 0.110669)),
        (500, 60, 51_880, (-0.977914, -0.179785, 14.608862, -3.937615, 0.639024)),
        (0, 150, 0, (0.877076, -0.574503, 0.606563, -0.470006, -0.024503)),
    ],
)
def test_skies_of_another_program(
    direct: float, diffuse: float, lux: float, parameters: tuple[float, ...]
) -> None:
    sky = perez.sky_of(
        perez.Weather(
            direct_normal=np.array([float(direct)]),
            diffuse_horizontal=np.array([float(diffuse)]),
            sun_zenith=np.array([50.0]),
            distance=np.sqrt(np.array([perez.SOLAR_CONSTANT / 1415.2])),
            dew_point=np.array([(math.log(2) + 0.075) / 0.07]),
        )
    )
    assert sky.direct_illuminance[0] == pytest.approx(lux, rel=1e-3)
    assert sky.parameters[0] == pytest.approx(parameters, abs=2e-3)


def test_a_compiled_sky_has_the_light_that_was_measured(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    document["environment"] = {
        "diffuse_horizontal": 120.0,
        "direct_normal": 600.0,
        "place": STUTTGART,
        "time": MORNING,
    }
    scene = compiled(document)
    sun = sun_at(at(MORNING), Place(48.8, 9.2, 250.0))
    east, north, up = sun.towards()[0]
    (disc,) = scene.distant_discs
    assert [disc.direction.x, disc.direction.y, disc.direction.z] == pytest.approx([east, up, -north])
    weather = perez.Weather(np.array([600.0]), np.array([120.0]), sun.zenith, sun.distance, np.array([11.0]))
    sky = perez.sky_of(weather)
    light = spectra.evaluate(scene.spectra[disc.radiance], visible_wavelengths()) @ spectra.response()[:, 1]
    across = math.pi * math.sin(disc.half_angle) ** 2 * light
    assert across == pytest.approx(sky.direct_illuminance[0], rel=1e-4)
    texels = standard_skies.mean_texels(
        lambda z, from_sun: perez.relative_luminance(sky.parameters[0], z, from_sun), up, 1024, 256
    )
    expected = texels / standard_skies.illuminance(texels) * sky.diffuse_illuminance[0]
    found = luminances(scene, blobs)
    assert found == pytest.approx(expected[::16, ::64], rel=2e-3)
    # Brightest at the Sun, which is at azimuth 0 of the map.
    row = int((1 - up) / 2 * 1024)
    assert expected[:512].argmax() // 256 == pytest.approx(row, abs=4)


def test_a_sky_too_dark_for_the_fit_is_even(
    document: dict[str, Any], compiled: Compile, blobs: BlobStore
) -> None:
    """As at an eclipse: the fit gives no direction any light, and the map was not finite."""
    document["environment"] = {
        "diffuse_horizontal": 5.025,
        "direct_normal": 9.366,
        "place": {"latitude": -12.33, "longitude": 8.0},
        "time": "2026-03-21T11:00Z",
    }
    found = luminances(compiled(document), blobs)
    above = found[: len(found) // 2]
    assert above == pytest.approx(np.full(above.shape, above[0, 0]), rel=1e-3)
    # W/m2 times some 250 lm/W of so dark a sky.
    assert above[0, 0] * math.pi == pytest.approx(5.025 * 250, rel=0.2)


def test_a_standard_sky_by_place_and_time_has_its_sun(document: dict[str, Any], compiled: Compile) -> None:
    document["environment"] = {
        "cie": 12,
        "illuminance": 10_000,
        "sun_illuminance": 80_000,
        "place": {**STUTTGART, "north": [1, 0, 0]},
        "time": MORNING,
    }
    scene = compiled(document)
    (disc,) = scene.distant_discs
    east, north, up = sun_at(at(MORNING), Place(48.8, 9.2, 250.0)).towards()[0]
    assert [disc.direction.x, disc.direction.y, disc.direction.z] == pytest.approx([north, up, east])
    document["environment"].pop("sun_illuminance")
    assert not compiled(document).distant_discs


SKY = {"diffuse_horizontal": 100, "direct_normal": 0}


@pytest.mark.parametrize(
    ("sky", "place", "words"),
    [
        (SKY, "$.environment.sun", "place and time"),
        (SKY | {"time": MORNING}, "$.environment.time", "add place"),
        (SKY | {"place": STUTTGART}, "$.environment.place", "add time"),
        (SKY | {"place": STUTTGART, "time": "2026-03-21T09:00"}, "$.environment.time", "no zone"),
        (SKY | {"place": STUTTGART, "time": "nine"}, "$.environment.time", "no time"),
        (SKY | {"place": STUTTGART, "time": "2026-03-21T02:00+01:00"}, "$.environment.time", "below"),
        (
            SKY | {"place": STUTTGART, "time": MORNING, "sun": [0, 1, 0]},
            "$.environment.sun",
            "expected sun, or",
        ),
        (
            SKY | {"place": {**STUTTGART, "north": [0, 1, 0]}, "time": MORNING},
            "$.environment.place.north",
            "parallel",
        ),
        ({"cie": 5, "illuminance": 1, "sun_illuminance": 1}, "$.environment.sun", "disc"),
    ],
)
def test_what_says_no_place_of_the_sun_is_refused(
    document: dict[str, Any], blobs: BlobStore, sky: dict[str, Any], place: str, words: str
) -> None:
    document["environment"] = sky
    expect_problem(document, blobs, place, words)
